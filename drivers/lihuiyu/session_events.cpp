// The half of LihuiyuSession that hears the board and watches it.

#include <algorithm>

#include <fmt/format.h>

#include "drivers/lihuiyu/session.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kAnswerTime{500};
constexpr milliseconds kQuietTime{200};
constexpr int kMostUnanswered = 3;
constexpr int kMostResends = 10;
constexpr seconds kBadStatusTime{3};
constexpr seconds kBusyMargin{10};  // Beyond the work that the board holds.
constexpr milliseconds kStopRepeat{200};
constexpr seconds kStopTime{5};
constexpr seconds kEndMargin{3};
constexpr seconds kLongestHoming{60};
constexpr double kSlowestHomingMmPerS = 30.0;

Session::Time::duration to_duration(double time_s) {
    return std::chrono::duration_cast<Session::Time::duration>(
        std::chrono::duration<double>(time_s));
}

std::string name_of(std::uint8_t status) {
    switch (static_cast<BoardStatus>(status)) {
        case BoardStatus::SerialOk:
            return "finished (M3)";
        case BoardStatus::Ok:
            return "ok";
        case BoardStatus::CrcError:
            return "packet rejected";
        case BoardStatus::Finished:
            return "finished";
        case BoardStatus::Busy:
            return "busy";
        case BoardStatus::Power:
            return "no power";
    }
    return "unknown";
}

}  // namespace

// ---- Wire ----

void LihuiyuSession::receive(std::string_view bytes, Time now) {
    now_ = now;
    if (gone_ || now_ < quiet_until_) {
        return;
    }
    reply_ += bytes;
    while (reply_.size() >= kStatusBytes) {
        const auto status = static_cast<std::uint8_t>(reply_[1]);
        reply_.erase(0, kStatusBytes);
        if (answered_ < asked_) {
            ++answered_;
            unanswered_ = 0;
            answer(status);
        }
    }
}

void LihuiyuSession::tick(Time now) {
    now_ = now;
    if (gone_) {
        return;
    }
    watch_answers();
    watch_status();
    watch_busy();
    watch_stop();
    watch_home();
    watch_end();
    send_next();
    if (answered_ == asked_ && now_ >= quiet_until_ && now_ - asked_at_ >= ask_interval()) {
        ask();
    }
    show_state();
}

void LihuiyuSession::ask() {
    output_ += kAskStatus;
    ++asked_;
    asked_at_ = now_;
}

void LihuiyuSession::write(const Outgoing& packet) {
    output_ += wire_bytes(packet.payload);
    sent_at_ = now_;
    ready_ = false;
    asked_at_packet_ = asked_;
    ask();
}

std::optional<LihuiyuSession::Outgoing> LihuiyuSession::next_packet() {
    if (job_runs() && holding_ != held_) {
        const bool works = progress_.lines_sent > 0 && !(finishing_ && now_ > motion_end_);
        if (board_holds_ || (holding_ && works)) {
            return Outgoing{
                make_payload("PN"), holding_ ? Purpose::Hold : Purpose::Resume, 0.0, {}};
        }
        held_ = holding_;  // The board has nothing to hold: it is enough to send nothing.
        held_since_ = now_;
    }
    if (packets_.empty() || (job_runs() && held_)) {
        return std::nullopt;
    }
    Outgoing packet = packets_.front();
    packets_.pop_front();
    if (packet.purpose == Purpose::Job) {
        ++progress_.lines_sent;
    }
    return packet;
}

void LihuiyuSession::send_next() {
    if (!ready_ || in_flight_ || stopping_) {
        return;
    }
    in_flight_ = next_packet();
    if (in_flight_) {
        resends_ = 0;
        doubtful_ = false;
        was_busy_ = false;
        write(*in_flight_);
    }
}

void LihuiyuSession::answer(std::uint8_t status) {
    if (status != last_status_) {
        last_status_ = status;
        status_since_ = now_;
        lines_.push_back(fmt::format("status {} ({})", status, name_of(status)));
    }
    if (answered_ <= asked_at_packet_) {
        return;  // Asked before the packet: says nothing about it.
    }
    const bool busy = status_is(BoardStatus::Busy);
    was_busy_ = was_busy_ || busy;
    if (busy || says_finished(status) || status_is(BoardStatus::Ok) ||
        status_is(BoardStatus::CrcError)) {
        attached_ = true;
    }
    finish_told_ = finish_told_ || (says_finished(status) && job_runs() && packets_.empty());
    if (stopping_) {
        answer_stop(status);
    } else if (status_is(BoardStatus::Ok)) {
        ready_ = true;
        confirm();
    } else if (status_is(BoardStatus::CrcError)) {
        in_flight_ ? reject() : static_cast<void>(ready_ = true);
    }
}

void LihuiyuSession::answer_stop(std::uint8_t status) {
    if (status_is(BoardStatus::Ok) || says_finished(status)) {
        stopping_ = false;
        ready_ = status_is(BoardStatus::Ok);
    } else if (status_is(BoardStatus::CrcError)) {
        write({make_payload("I"), Purpose::Stop, 0.0, std::nullopt});
    }
}

void LihuiyuSession::confirm() {
    if (!in_flight_) {
        return;
    }
    const Outgoing packet = *in_flight_;
    in_flight_.reset();
    motion_end_ = std::max(motion_end_, now_) + to_duration(packet.seconds);
    if (packet.end) {
        place_ = *packet.end;
    }
    switch (packet.purpose) {
        case Purpose::Job:
            ++progress_.lines_acknowledged;
            break;
        case Purpose::Hold:
            held_ = board_holds_ = true;
            held_since_ = now_;
            break;
        case Purpose::Resume:
            held_ = board_holds_ = false;
            motion_end_ += now_ - held_since_;
            break;
        case Purpose::Home:
            homing_since_ = now_;
            break;
        case Purpose::Stop:
        case Purpose::Rails:
        case Purpose::Jog:
            break;
    }
}

void LihuiyuSession::reject() {
    if (doubtful_) {
        doubtful_ = false;  // Ask once more before the same cut is sent twice.
        return;
    }
    if (++resends_ > kMostResends) {
        fail(
            fmt::format("the board rejects packet {} of {} again and again; the USB cable is bad, "
                        "too long, or lies beside the laser's supply",
                        progress_.lines_sent, progress_.lines_total));
        return;
    }
    write(*in_flight_);
}

// ---- Watching ----

bool LihuiyuSession::status_is(BoardStatus status) const {
    return last_status_ == static_cast<std::uint8_t>(status);
}

milliseconds LihuiyuSession::ask_interval() const {
    const bool waiting = in_flight_ || stopping_ || (!packets_.empty() && !held_) ||
                         (job_runs() && holding_ != held_);
    if (waiting || !attached_) {
        return milliseconds(5);
    }
    // The board says for 390 ms that it has finished.
    return finishing_ || moving_by_hand_ ? milliseconds(50) : milliseconds(500);
}

void LihuiyuSession::fail(const std::string& reason) {
    begin_stop(fmt::format("{}; stopped, the place of the head is lost", reason),
               JobOutcome::Failed);
}

void LihuiyuSession::watch_answers() {
    if (answered_ == asked_ || now_ - asked_at_ < kAnswerTime) {
        return;
    }
    answered_ = asked_;
    reply_.clear();
    doubtful_ = true;
    quiet_until_ = now_ + kQuietTime;
    if (++unanswered_ >= kMostUnanswered) {
        throw LinkLost("the board doesn't answer any more");
    }
}

// Statuses with which no board goes on.
void LihuiyuSession::watch_status() {
    const bool good = status_is(BoardStatus::Ok) || status_is(BoardStatus::CrcError) ||
                      status_is(BoardStatus::Busy) || says_finished(last_status_);
    if (answered_ == 0 || now_ - status_since_ < kBadStatusTime) {
        return;
    }
    const bool known = last_status_ == static_cast<std::uint8_t>(BoardStatus::SerialOk) ||
                       last_status_ == static_cast<std::uint8_t>(BoardStatus::Finished) ||
                       !says_finished(last_status_);
    if (good && known) {
        return;
    }
    const std::string reason =
        status_is(BoardStatus::Power)
            ? "the board says that it has no power (239): is the laser switched on?"
            : fmt::format("the answer {} is not that of a Lihuiyu board", last_status_);
    if (!attached_) {
        throw LinkLost(reason);
    }
    if (job_runs() || moving_by_hand_) {
        fail(reason);
    }
}

void LihuiyuSession::watch_busy() {
    const bool waits = in_flight_ || (!packets_.empty() && !held_) || finishing_;
    if (!job_runs() || !waits || !status_is(BoardStatus::Busy) || held_) {
        return;
    }
    const auto work = to_duration(in_flight_ ? in_flight_->seconds : 0.0);
    const Time end = std::max(motion_end_ + work, status_since_);
    if (now_ > end + kBusyMargin + (end - status_since_) / 4) {
        fail("the board stays busy for longer than the work that it holds can take");
    }
}

void LihuiyuSession::watch_stop() {
    if (!stopping_) {
        return;
    }
    if (now_ - stopping_since_ > kStopTime) {
        stopping_ = false;
        status_.message = "the board doesn't confirm the stop: SWITCH THE LASER OFF at the machine";
        lines_.push_back(status_.message);
    } else if (now_ - sent_at_ > kStopRepeat) {
        write({make_payload("I"), Purpose::Stop, 0.0, std::nullopt});
    }
}

void LihuiyuSession::watch_home() {
    if (!homing_ || !homing_since_ || in_flight_ || !packets_.empty()) {
        return;
    }
    const double way_mm = std::max(options_.bed.width_mm, options_.bed.height_mm);
    const auto slowest = to_duration(2.0 + way_mm / kSlowestHomingMmPerS);
    const bool stands = !status_is(BoardStatus::Busy) && answered_ > asked_at_packet_;
    if (stands && (was_busy_ || now_ - *homing_since_ > slowest)) {
        homing_ = moving_by_hand_ = false;
        homed_ = true;
        place_ = {};
        status_.message.clear();
    } else if (now_ - *homing_since_ > kLongestHoming) {
        fail("homing doesn't end: does the head reach its switches?");
    }
}

void LihuiyuSession::watch_end() {
    const bool all_taken = packets_.empty() && !in_flight_ && !held_ && !holding_;
    if (moving_by_hand_ && !homing_ && all_taken) {
        moving_by_hand_ = now_ <= motion_end_ + milliseconds(200);
    }
    if (!job_runs() || !all_taken) {
        return;
    }
    if (!finishing_) {
        finishing_ = true;
        return;
    }
    // Some boards never say that they have finished.
    const bool must_have = status_is(BoardStatus::Ok) && now_ > motion_end_ + kEndMargin;
    if (finish_told_ || must_have) {
        finishing_ = false;
        progress_.outcome = JobOutcome::Done;
    }
}

}  // namespace leafcutter::drivers
