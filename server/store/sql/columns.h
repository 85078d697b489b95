// All tables that hold what may not be lost, with their columns: the same in every engine. A test
// holds both schemas to it.

#pragma once

#include <array>
#include <string_view>

namespace leafcutter::server {

struct SqlTable {
    std::string_view name;
    std::string_view key;      // Columns that order its rows, each row at its own place.
    std::string_view columns;  // Words "name:kind"; kinds are number, real, text.
    std::string_view counted;  // The column that the engine numbers by itself; empty: none.
};

// Parents before their children. Leases and nodes are not among them: they mean nothing elsewhere.
constexpr std::array kSqlTables{
    SqlTable{"job", "ordinal",
             "ordinal:number id:text name:text state:text version:number created_ms:number "
             "updated_ms:number file_name:text file_bytes:number file_sha256:text params:text "
             "attempt:number error_kind:text error_code:text error_detail:text summary:text "
             "recut_of:text priority:number place:number retries:number retry_cause:text "
             "owner:text fence:number lease_until_ms:number recut:text",
             "ordinal"},
    SqlTable{"artifact", "job, path",
             "job:text position:number path:text bytes:number sha256:text media_type:text", ""},
    SqlTable{"sheet", "job, number",
             "job:text number:number material:text program_sha256:text estimated_s:real "
             "cut:number width_mm:real height_mm:real stock:text offcut:text",
             ""},
    SqlTable{"cut", "ordinal",
             "ordinal:number id:text job:text device:text sheets:text position:number state:text "
             "version:number lines_total:number lines_sent:number lines_acknowledged:number "
             "reason:text created_ms:number updated_ms:number rest_of:text rest_sha256:text "
             "beam:text owner:text fence:number",
             "ordinal"},
    SqlTable{"cut_intent", "id", "id:number cut:text sheet:number program_sha256:text at_ms:number",
             "id"},
    SqlTable{"device", "id",
             "id:text name:text uri:text auto_start:number bed_width_mm:real "
             "bed_height_mm:real station:text",
             ""},
    SqlTable{"event", "seq", "seq:number at_ms:number type:text subject:text job:text note:text",
             ""},
    SqlTable{"idempotency", "key", "key:text request_hash:text job:text at_ms:number", ""},
    SqlTable{"material", "id", "id:text record:text", ""},
    SqlTable{"preset", "id", "id:text record:text", ""},
    SqlTable{"setting", "key", "key:text value:text", ""},
    SqlTable{"stock", "id",
             "id:text record:text material:text quantity:number note:text from_job:text "
             "from_sheet:number created_ms:number updated_ms:number",
             ""},
    SqlTable{"account", "name", "name:text role:text password_hash:text created_ms:number", ""},
    SqlTable{"api_key", "id",
             "id:text account:text label:text role:text may_fire:number secret_hash:text "
             "created_ms:number expires_ms:number",
             ""},
    SqlTable{"session", "token_hash", "token_hash:text account:text created_ms:number", ""},
    SqlTable{"audit", "seq",
             "seq:number at_ms:number account:text remote:text action:text note:text "
             "status:number",
             "seq"},
};

}  // namespace leafcutter::server
