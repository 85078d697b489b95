// Made by generate_types.mjs from the daemon's openapi.json: change that, not this.

export type Job = {
  readonly id: string;
  readonly name: string;
  readonly state: "queued" | "computing" | "ready" | "done" | "failed" | "cancelled";
  readonly created_at: string;
  readonly updated_at: string;
  readonly version: number;
  readonly file: {
    readonly name?: string;
    readonly bytes?: number;
    readonly sha256?: string;
  };
  readonly params: JobParams;
  readonly progress: {
    readonly stage?: string;
    readonly fraction?: number;
  };
  readonly error: {
    readonly kind?: string;
    readonly code?: string;
    readonly detail?: string;
  } | null;
  readonly summary: {
    readonly quads?: number;
    readonly strips?: number;
    readonly pieces?: number;
    readonly sheets?: number;
    readonly estimated_s?: number;
    readonly warnings?: readonly (string)[];
    readonly test?: "kerf" | "power";
    readonly reading?: string;
  } | null;
  readonly sheets: readonly ({
    readonly id?: number;
    readonly material?: string;
    readonly state?: "uncut" | "cut";
    readonly program_sha256?: string;
    readonly estimated_s?: number;
    readonly size_mm?: readonly (number)[];
    readonly stock?: string | null;
  })[];
  readonly cuts: readonly (string)[];
  readonly actions: readonly ("cancel" | "remove" | "cut" | "recompute" | "recut" | "retry" | "move")[];
  readonly recut_of?: string | null;
  readonly priority?: number;
  readonly attempt?: number;
  readonly retries?: number;
  readonly retry_cause?: string;
  readonly dead_letter?: boolean;
};

export type Artifact = {
  readonly path: string;
  readonly bytes: number;
  readonly sha256: string;
  readonly media_type: string;
};

export type Cut = {
  readonly id: string;
  readonly job: string;
  readonly device: string;
  readonly sheets: readonly (number)[];
  readonly sheet: number;
  readonly state: "waiting" | "armed" | "cutting" | "paused" | "awaiting-sheet" | "done" | "aborted" | "failed" | "interrupted";
  readonly version: number;
  readonly program_sha256: string;
  readonly progress: {
    readonly lines_total?: number;
    readonly lines_sent?: number;
    readonly lines_acknowledged?: number;
    readonly fraction?: number;
    readonly burnt_mm?: number;
    readonly burn_mm?: number;
  };
  readonly beam: {
    readonly burnt_mm?: number;
    readonly least_mm?: number;
    readonly most_mm?: number;
    readonly total_mm?: number;
    readonly percent?: number;
    readonly line?: number;
    readonly at_mm?: readonly (number)[];
    readonly certain?: boolean;
    readonly position_kept?: boolean;
  } | {
    readonly burnt_mm?: number;
    readonly least_mm?: number;
    readonly most_mm?: number;
    readonly total_mm?: number;
    readonly percent?: number;
    readonly line?: number;
    readonly at_mm?: readonly (number)[];
    readonly certain?: boolean;
    readonly position_kept?: boolean;
  };
  readonly rest_of: string | null;
  readonly reason: string;
  readonly created_at: string;
  readonly updated_at: string;
  readonly steps: readonly ({
    readonly step: "remove-sheet" | "load-sheet" | "keep-sheet" | "home" | "measure-burnt" | "frame" | "bed-clear" | "start" | "confirm-sheet" | "finish";
    readonly required: boolean;
    readonly done: boolean | null;
    readonly sheet?: number;
    readonly material?: string;
    readonly size_mm?: readonly (number)[];
    readonly stock?: string | null;
  })[];
  readonly actions: readonly ("start" | "pause" | "resume" | "abort" | "confirm-sheet" | "finish")[];
};

export type Device = {
  readonly id: string;
  readonly name: string;
  readonly uri: string;
  readonly auto_start: boolean;
  readonly bed_mm: readonly (number)[];
  readonly status: {
    readonly state?: "disconnected" | "idle" | "run" | "hold" | "jog" | "home" | "alarm" | "door" | "check" | "sleep" | "unknown";
    readonly machine_position_mm?: readonly (number)[];
    readonly work_position_mm?: readonly (number)[];
    readonly feed_mm_per_min?: number;
    readonly power_s?: number;
    readonly override_percent?: readonly (number)[];
    readonly alarm_code?: number;
    readonly message?: string;
    readonly firmware?: string;
  };
  readonly cut: string | null;
  readonly console: readonly (string)[];
  readonly actions: readonly (string)[];
  readonly station: string | null;
};

export type Port = {
  readonly uri?: string;
  readonly path?: string;
  readonly stable_path?: string;
  readonly usb_id?: string;
  readonly description?: string;
  readonly serial_number?: string;
  readonly trouble?: string;
};

export type Material = {
  readonly id?: string;
  readonly name?: string;
  readonly colour?: string;
  readonly thickness_mm: number;
  readonly weight_g_per_m2: number;
  readonly kerf_mm: number;
  readonly min_strip_width_mm?: number;
  readonly min_radius_mm?: number;
  readonly min_length_mm?: number;
  readonly grain_deg?: 0 | 90 | null;
  readonly grain_tolerance_deg?: number;
  readonly sheets: readonly ({
    readonly width_mm: number;
    readonly height_mm: number;
    readonly price?: number | null;
  })[];
  readonly price_per_m2?: number | null;
  readonly currency?: string;
  readonly cut: Laser;
  readonly score: Laser;
  readonly engrave: Laser;
  readonly settings?: readonly ({
    readonly machine: string;
    readonly kerf_mm?: number;
    readonly cut: Laser;
    readonly score: Laser;
    readonly engrave: Laser;
  })[];
  readonly origin?: "built-in" | "changed" | "own";
};

export type Laser = {
  readonly power_percent?: number;
  readonly feed_mm_per_min?: number;
  readonly passes?: number;
};

export type Problem = {
  readonly type: string;
  readonly title: string;
  readonly status: number;
  readonly detail: string;
  readonly code: string;
  readonly errors?: readonly ({
    readonly pointer?: string;
    readonly detail?: string;
  })[];
};

export type FoliationParams = {
  readonly mode?: "auto" | "pants" | "one-form" | "disk" | "annulus" | "torus" | "sphere-polar" | "sphere-pillowcase";
  readonly torus_rings?: "short" | "long";
  readonly corners?: readonly (number)[];
  readonly pants?: "reeb" | "handle-loops" | "tunnel-loops" | "user";
  readonly loops?: readonly (readonly (number)[])[];
  readonly forbid?: readonly (readonly (number)[])[];
  readonly function?: "auto" | "harmonic" | "x" | "y" | "z" | "fiedler";
  readonly weights?: "auto" | readonly (number)[];
  readonly poles?: readonly (number)[];
  readonly sources?: readonly (number | readonly (number)[])[];
  readonly sinks?: readonly (number | readonly (number)[])[];
  readonly punctures?: "auto" | "none" | readonly ({
    readonly vertex: number;
    readonly radius_mm: number;
  })[];
  readonly singularities?: readonly ({
    readonly near: number | readonly (number)[];
  })[];
  readonly components?: "each" | "largest";
};

export type CutParams = {
  readonly lead_in_mm?: number;
  readonly over_cut_mm?: number | "auto";
  readonly tabs?: number;
  readonly tab_mm?: number;
  readonly common_edges?: boolean;
  readonly heat?: number;
};

export type JobParams = {
  readonly foliation?: FoliationParams;
  readonly cut?: CutParams;
};

export type Queue = {
  readonly paused: boolean;
  readonly reason: string;
  readonly queued: number;
  readonly computing: number;
  readonly dead_letters: number;
  readonly next: readonly ({
    readonly id?: string;
    readonly name?: string;
    readonly priority?: number;
  })[];
};

export type StockEntry = {
  readonly id: string;
  readonly material?: string;
  readonly width_mm?: number;
  readonly height_mm?: number;
  readonly outline?: readonly (readonly (number)[])[];
  readonly holes?: readonly (readonly (readonly (number)[])[])[];
  readonly defects?: readonly (readonly (readonly (number)[])[])[];
  readonly keep_out?: readonly (readonly (readonly (number)[])[])[];
  readonly quantity?: number | null;
  readonly cost?: number;
  readonly note?: string;
  readonly kind?: "sheet" | "remnant";
  readonly planned?: number;
  readonly from_job?: string | null;
  readonly from_sheet?: number | null;
  readonly created_at?: string;
  readonly updated_at?: string;
};

export type Stock = {
  readonly format?: "leafcutter-stock/1";
  readonly stock: readonly (StockEntry)[];
  readonly next_cursor?: string | null;
};

export type Preset = {
  readonly id?: string;
  readonly name?: string;
  readonly description?: string;
  readonly params: JobParams;
  readonly origin?: "built-in" | "changed" | "own";
};

export type Presets = {
  readonly presets: readonly (Preset)[];
  readonly next_cursor?: string | null;
};

export type Retention = {
  readonly jobs_days?: number;
  readonly packages_days?: number;
  readonly events_days?: number;
  readonly backup_every_min?: number;
  readonly backups_kept?: number;
};

export type Role = "viewer" | "submitter" | "operator" | "admin";

export type Session = {
  readonly accounts: boolean;
  readonly authenticated: boolean;
  readonly user: string | null;
  readonly role: Role | null;
  readonly may_fire: boolean;
  readonly csrf_token: string | null;
};

export type User = {
  readonly name: string;
  readonly role: Role;
  readonly created_at: string;
};

export type Key = {
  readonly id: string;
  readonly user: string;
  readonly label: string;
  readonly role: Role;
  readonly may_fire: boolean;
  readonly created_at: string;
  readonly expires_at: string | null;
  readonly used_at: string | null;
};

export type AuditEntry = {
  readonly seq: number;
  readonly at: string;
  readonly user: string | null;
  readonly remote: string;
  readonly action: string;
  readonly note: string;
  readonly status: number;
};

export type MachineSetting = {
  readonly key: string;
  readonly value: number;
  readonly name: string;
};

export type FleetNode = {
  readonly id: string;
  readonly role: "all" | "api" | "worker" | "station";
  readonly url: string;
  readonly version: string;
  readonly mode: "active" | "paused" | "draining";
  readonly state: "active" | "paused" | "draining" | "drained" | "silent";
  readonly silent_s: number;
  readonly joined_at: string;
  readonly seen_at: string;
  readonly machines: readonly (string)[];
  readonly workers: number;
  readonly computing: number;
  readonly cutting: number;
  readonly database_ms: number;
  readonly actions: readonly (string)[];
};

export type Fleet = {
  readonly alone: boolean;
  readonly node: string | null;
  readonly lease_s: number | null;
  readonly nodes: readonly (FleetNode)[];
  readonly machine_leases: readonly ({
    readonly device: string;
    readonly station: string;
    readonly fence: number;
    readonly held: boolean;
    readonly left_s: number;
  })[];
  readonly duties: readonly ({
    readonly duty: string;
    readonly node: string;
    readonly held: boolean;
  })[];
  readonly claims: readonly ({
    readonly job: string;
    readonly worker: string;
    readonly fence: number;
    readonly attempt: number;
    readonly until: string;
  })[];
};

export type Call =
  | "GET /jobs"
  | "POST /jobs"
  | "GET /jobs/{id}"
  | "PATCH /jobs/{id}"
  | "DELETE /jobs/{id}"
  | "POST /jobs/{id}/recompute"
  | "POST /jobs/{id}/recut"
  | "POST /test-cards"
  | "GET /jobs/{id}/artifacts"
  | "GET /jobs/{id}/artifacts/{path}"
  | "GET /jobs/{id}/mesh"
  | "GET /jobs/{id}/package.zip"
  | "GET /jobs/{id}/events"
  | "POST /jobs/{id}/cuts"
  | "GET /blobs/{sha256}"
  | "PUT /blobs/{sha256}"
  | "GET /cuts"
  | "GET /cuts/{id}"
  | "POST /cuts/{id}/start"
  | "POST /cuts/{id}/confirm-sheet"
  | "POST /cuts/{id}/pause"
  | "POST /cuts/{id}/resume"
  | "POST /cuts/{id}/finish"
  | "POST /cuts/{id}/abort"
  | "GET /devices"
  | "GET /devices/{id}"
  | "PUT /devices/{id}"
  | "DELETE /devices/{id}"
  | "POST /devices/{id}/commands"
  | "GET /ports"
  | "GET /materials"
  | "POST /materials"
  | "GET /materials/{id}"
  | "PUT /materials/{id}"
  | "DELETE /materials/{id}"
  | "GET /events"
  | "GET /version"
  | "GET /openapi.json"
  | "GET /healthz"
  | "GET /readyz"
  | "GET /metrics"
  | "POST /jobs/{id}/retry"
  | "GET /queue"
  | "POST /queue/pause"
  | "POST /queue/resume"
  | "GET /stock"
  | "POST /stock"
  | "GET /stock/{id}"
  | "PUT /stock/{id}"
  | "DELETE /stock/{id}"
  | "GET /presets"
  | "POST /presets"
  | "GET /presets/{id}"
  | "PUT /presets/{id}"
  | "DELETE /presets/{id}"
  | "GET /retention"
  | "PUT /retention"
  | "GET /backups"
  | "POST /backups"
  | "GET /session"
  | "POST /session"
  | "DELETE /session"
  | "GET /users"
  | "POST /users"
  | "GET /users/{name}"
  | "PUT /users/{name}"
  | "DELETE /users/{name}"
  | "GET /keys"
  | "POST /keys"
  | "DELETE /keys/{id}"
  | "GET /audit"
  | "GET /devices/{id}/settings"
  | "GET /fleet"
  | "POST /fleet/{id}/pause"
  | "POST /fleet/{id}/drain"
  | "POST /fleet/{id}/resume"
  | "DELETE /fleet/{id}";
