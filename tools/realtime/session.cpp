#include "tools/realtime/session.h"

#include <time.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "core/numerics/random.h"
#include "core/text/parse.h"
#include "tools/realtime/photorque_serve.h"

namespace photorque {
namespace {

namespace serve_key {
constexpr ChoiceKey mode("mode",
                         {{"paced", "by the clock"},
                          {"lockstep", "every tick waits for the client's answer"}},
                         0, "clock of the ticks");
constexpr NumberKey rate("rate_Hz", 160.0, {0.1, 1e5},
                         "rate of the ticks and of the rows of `recording.csv`");
constexpr TextKey address("address", "127.0.0.1", "IPv4 address of the UDP socket");
constexpr IntegerKey port("port", PHOTORQUE_PORT, 0, 65535,
                          "UDP port; 0: a free port, which the first line of the output states");
constexpr FlagKey wait_for_client("wait_for_client", true,
                                  "true: the first tick waits for a client");
constexpr NumberKey client_timeout("client_timeout_s", 60.0, {1e-3, 1e6},
                                   "longest wait for the first hello and, in lockstep, for every "
                                   "answer; afterwards the run ends with status 3");
constexpr NumberKey max_torque("max_torque_N_m", 1.0, Range::positive(),
                               "commands with a larger torque are rejected");
constexpr NumberKey silence("silence_s", 2.0, {0.01, 1e6},
                            "paced: after this time without a packet of the client, the torque is "
                            "zero and another client is accepted");
constexpr NumberKey hold("hold_s", Range::positive(),
                         "a command that is not renewed within this time becomes zero",
                         {.usually = "never"});
constexpr NumberKey deadline("deadline_s", Range::positive(),
                             "a tick that is served later than this counts as missed",
                             {.usually = "a step"});
constexpr ChoiceKey on_miss("on_miss",
                            {{"catch_up", "the next ticks follow at once"},
                             {"slip", "the clock is set back"},
                             {"stop", "the run ends"}},
                            0, "after a missed tick");
constexpr NumberKey spin("spin_s", 50e-6, {0.0, 1.0},
                         "time before a tick in which the run polls instead of sleeping; costs "
                         "processor time, avoids the delay of waking up");
constexpr IntegerKey realtime_priority(
    "realtime_priority", 0, 0, 99,
    "priority under SCHED_FIFO, with locked memory, if the system permits it; 0: none");
constexpr FlagKey send_truth("send_truth", false,
                             "true: every measurement contains the true attitude and rate");
constexpr TableKey to_client("to_client", "a simulated link for measurements");
constexpr TableKey from_client("from_client", "a simulated link for commands");
constexpr TableKey serve("serve", "a run in real time");
}  // namespace serve_key

}  // namespace

ServeSettings read_serve(const Settings& root) {
  const Settings s = own_table(root, "serve", false);
  ServeSettings serve;
  serve.mode = static_cast<ServeSettings::Mode>(s.get(serve_key::mode));
  serve.rate_Hz = s.get(serve_key::rate);
  serve.address = s.get(serve_key::address);
  serve.port = static_cast<int>(s.get(serve_key::port));
  serve.wait_for_client = s.get(serve_key::wait_for_client);
  serve.client_timeout_s = s.get(serve_key::client_timeout);
  serve.max_torque_N_m = s.get(serve_key::max_torque);
  serve.silence_s = s.get(serve_key::silence);
  serve.hold_s = s.get_or(serve_key::hold, std::numeric_limits<double>::infinity());
  serve.deadline_s = s.get_or(serve_key::deadline, 1.0 / serve.rate_Hz);
  serve.on_miss = static_cast<OnMiss>(s.get(serve_key::on_miss));
  serve.spin_s = s.get(serve_key::spin);
  serve.realtime_priority = static_cast<int>(s.get(serve_key::realtime_priority));
  serve.send_truth = s.get(serve_key::send_truth);
  const auto folder = std::filesystem::path(root.where().file).parent_path();
  if (s.has(serve_key::to_client)) serve.to_client = read_link(s.get(serve_key::to_client), folder);
  if (s.has(serve_key::from_client))
    serve.from_client = read_link(s.get(serve_key::from_client), folder);
  s.finish();
  return serve;
}

namespace {

enum LinkStream : uint64_t { stream_to_client = 0x70, stream_from_client };

constexpr int64_t never_ns = std::numeric_limits<int64_t>::max();

// Maximum number of packets that a paced tick reads, so that a flood of packets cannot delay it. It
// is about the default capacity of a socket; further packets wait for the next tick.
constexpr size_t packets_a_tick = 256;
// Maximum number of events that are printed; further ones are counted.
constexpr size_t most_events = 1000;

int64_t in_ns(double seconds) {
  return std::llround(1e9 * seconds);
}

void sleep_until(int64_t until_ns) {
  constexpr int64_t second_ns = 1'000'000'000;
  const timespec until{until_ns / second_ns, until_ns % second_ns};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

// A number that differs between runs, so that packets for an earlier run are recognised. Not zero.
uint64_t run_number() {
  return hash_words(static_cast<uint64_t>(monotonic_ns()), static_cast<uint64_t>(::getpid())) | 1;
}

}  // namespace

Session::Session(const ServeSettings& settings, UdpSocket socket, uint64_t seed, double start_s,
                 std::function<void(const std::string&)> report)
    : settings_(settings),
      socket_(std::move(socket)),
      start_s_(start_s),
      run_(run_number()),
      gate_(run_, settings.max_torque_N_m,
            settings.mode == ServeSettings::Mode::paced ? in_ns(settings.silence_s) : never_ns),
      clock_(1.0 / settings.rate_Hz, settings.deadline_s, settings.on_miss),
      to_client_(settings.to_client, seed, stream_to_client),
      from_client_(settings.from_client, seed, stream_from_client),
      report_(std::move(report)),
      events_(Table::of("session_events", "Clients: arrivals, silences, departures",
                        {"time_s", "event"})) {}

// Time since the start [s]: of the clock, or of the tick in lockstep.
double Session::now_s() const {
  return is_paced() ? clock_.run_s(monotonic_ns()) : tick_s_;
}

ZeroOrderHold Session::tick(const LiveRow& row) {
  tick_ = row.index;
  tick_s_ = row.time_s - start_s_;
  if (packets_of_tick_ >= packets_a_tick) ++full_ticks_;
  packets_of_tick_ = 0;
  if (tick_ == 0) await_client();
  const int64_t computing_ns = tick_ == 0 ? 0 : monotonic_ns() - returned_ns_;
  bool is_late = false;
  if (is_paced()) {
    wait_until_due(tick_);
    is_late =
        1e-9 * static_cast<double>(monotonic_ns() - clock_.due_ns(tick_)) > settings_.deadline_s;
  }
  to_client_.push(packet_of(row), is_paced() ? std::max(now_s(), tick_s_) : tick_s_);
  send_arrived(now_s(), is_late);
  if (is_paced()) {
    clock_.served(tick_, monotonic_ns(), computing_ns);
    while (take_in(0)) {
    }
  } else {
    await_answer();
  }
  command(now_s());
  if (is_paced()) end_after_silence();
  ZeroOrderHold held;
  if (acting_.header.sequence != 0) {
    held.command_body_N_m =
        Vec3(acting_.torque_body_N_m[0], acting_.torque_body_N_m[1], acting_.torque_body_N_m[2]);
  }
  acted_.append(row.time_s, held);
  returned_ns_ = monotonic_ns();
  return held;
}

void Session::await_client() {
  const int64_t give_up_ns = monotonic_ns() + in_ns(settings_.client_timeout_s);
  while ((settings_.wait_for_client || !is_paced()) && !gate_.client()) {
    packets_of_tick_ = 0;  // the limit per tick does not apply here
    take_in(give_up_ns);
    if (monotonic_ns() > give_up_ns) {
      throw NumericalError("no client came to " + socket_.where() + " within " +
                           shortest(settings_.client_timeout_s) + " s (serve.client_timeout_s)");
    }
  }
  clock_.start(monotonic_ns());
}

// Waits until the tick is due; meanwhile receives commands and sends delayed measurements.
void Session::wait_until_due(size_t tick) {
  const int64_t due_ns = clock_.due_ns(tick);
  while (monotonic_ns() < due_ns) {
    const double next_s = to_client_.next_due_s();
    int64_t until_ns = due_ns;
    if (std::isfinite(next_s)) {
      until_ns = std::min(due_ns, monotonic_ns() + std::max<int64_t>(0, in_ns(next_s - now_s())));
    }
    if (!take_in(until_ns)) sleep_until(until_ns);
    send_arrived(now_s(), false);
  }
}

// Sends the measurements that have passed the simulated link. In lockstep, the last of them, or an
// empty one if there is none, requests the answer.
void Session::send_arrived(double now_s, bool is_late) {
  const uint32_t late = is_late ? uint32_t{PHOTORQUE_LATE} : 0;
  std::optional<photorque_measurement_packet> packet = to_client_.pop(now_s);
  if (is_paced()) {
    for (; packet; packet = to_client_.pop(now_s)) send(*packet, PHOTORQUE_NEW | late);
    return;
  }
  if (!packet) {
    photorque_measurement_packet empty = last_sent_;
    send(empty, PHOTORQUE_ANSWER);
    return;
  }
  while (const auto next = to_client_.pop(now_s)) {
    send(*packet, PHOTORQUE_NEW);
    packet = next;
  }
  send(*packet, PHOTORQUE_NEW | PHOTORQUE_ANSWER);
}

void Session::send(const photorque_measurement_packet& packet, uint32_t flags) {
  last_sent_ = packet;
  last_sent_.now_tick = tick_;
  last_sent_.step_s = 1.0 / settings_.rate_Hz;
  last_sent_.flags = flags | (settings_.send_truth ? uint32_t{PHOTORQUE_TRUTH} : 0);
  last_sent_.refused = static_cast<uint32_t>(gate_.total_refused());
  last_sent_.header.run = run_;
  last_sent_.header.sequence = ++sequence_;
  last_sent_.header.sent_ns = static_cast<uint64_t>(monotonic_ns());
  photorque_seal(&last_sent_.header, PHOTORQUE_MEASUREMENT, sizeof last_sent_);
  if (!gate_.client()) return;
  socket_.send(last_sent_, *gate_.client());
  ++sent_;
}

// Waits for the answer and repeats the request, because datagrams may be lost even on one machine.
void Session::await_answer() {
  const int64_t give_up_ns = monotonic_ns() + in_ns(settings_.client_timeout_s);
  constexpr int64_t again_ns = 200'000'000;
  answered_ = false;
  int64_t until_ns = 0;
  while (!answered_ && !client_left_) {
    if (monotonic_ns() >= until_ns) until_ns = std::min(give_up_ns, monotonic_ns() + again_ns);
    take_in(until_ns);
    const int64_t now_ns = monotonic_ns();
    if (now_ns >= give_up_ns && !answered_ && !client_left_) {
      throw NumericalError("the client did not answer tick " + std::to_string(tick_) + " within " +
                           shortest(settings_.client_timeout_s) + " s (serve.client_timeout_s)");
    }
    if (now_ns >= until_ns && !answered_ && gate_.client()) {
      socket_.send(last_sent_, *gate_.client());
    }
  }
}

// Receives one packet, waiting for it until `until_ns`. Returns whether there was one within the
// limit per tick.
bool Session::take_in(int64_t until_ns) {
  if (is_paced() && packets_of_tick_ >= packets_a_tick) return false;
  const std::optional<ReceivedBytes> got = socket_.receive(until_ns);
  if (!got) return false;
  ++packets_of_tick_;
  const std::span<const std::byte> bytes(got->bytes.data(), std::min(got->size, got->bytes.size()));
  const std::optional<ClientPacket> packet = gate_.admit(bytes, got->sender, monotonic_ns());
  if (!packet) return true;
  ++received_;
  fell_silent_ = false;
  if (packet->kind == PHOTORQUE_HELLO) client_left_ = false;
  if (packet->begins_session) {
    ++sessions_;
    end_command();
    note("a session begins, from " + UdpSocket::text_of(got->sender));
  }
  if (packet->kind == PHOTORQUE_GOODBYE) {
    client_left_ = true;
    end_command();
    note("goodbye of the client: no torque");
  }
  if (packet->kind != PHOTORQUE_COMMAND) return true;
  if (is_paced()) {
    from_client_.push(packet->command, now_s());
  } else if (!answered_ && packet->command.header.tick == tick_) {
    answered_ = true;
    from_client_.push(packet->command, tick_s_);
  } else {
    ++unanswered_;
  }
  return true;
}

// Clears the last command of a session and those in the simulated link, so that none of them acts
// in the next session.
void Session::end_command() {
  acting_ = {};
  from_client_.clear();
}

void Session::note(const std::string& event) {
  if (events_.columns.front().size() >= most_events) return;
  events_.row().set("time_s", start_s_ + tick_s_).set("event", event);
  report_("  at " + shortest(start_s_ + tick_s_) + " s: " + event);
}

// Ends the torque of a client that has become silent without a goodbye.
void Session::end_after_silence() {
  if (!gate_.is_silent(monotonic_ns())) return;
  std::ranges::fill(acting_.torque_body_N_m, 0.0);
  if (fell_silent_) return;
  fell_silent_ = true;
  ++silences_;
  note("the client is silent for " + shortest(settings_.silence_s) + " s: no torque");
}

// Applies the newest command that has passed the link.
void Session::command(double now_s) {
  while (const auto arrived = from_client_.pop(now_s)) {
    if (client_left_) continue;
    if (arrived->header.sequence <= acting_.header.sequence) {
      ++overtaken_;
      continue;
    }
    acting_ = *arrived;
    acting_since_s_ = now_s;
  }
  if (now_s - acting_since_s_ > settings_.hold_s) {
    // After a timeout, older commands must not become active.
    std::ranges::fill(acting_.torque_body_N_m, 0.0);
  }
}

photorque_measurement_packet Session::packet_of(const LiveRow& row) const {
  photorque_measurement_packet packet{};
  packet.header.tick = row.index;
  packet.command_sequence = acting_.header.sequence;
  packet.command_sent_ns = acting_.header.sent_ns;
  packet.t_s = row.time_s;
  const auto put = [](const Quat& q, double* to) {
    to[0] = q.w(), to[1] = q.x(), to[2] = q.y(), to[3] = q.z();
  };
  put(row.lab_from_body_seen, packet.attitude);
  for (int i = 0; i < 3; ++i) {
    packet.gyro_rad_s[i] = row.gyro_rad_s[i];
    packet.command_body_N_m[i] = row.command_body_N_m[i];
  }
  packet.yaw_rad = row.yaw_rad;
  packet.battery_current_A = row.battery_current_A;
  packet.array_power_W = row.array_power_W;
  if (settings_.send_truth) {
    put(row.truth.lab_from_body, packet.true_attitude);
    for (int i = 0; i < 3; ++i) packet.true_rate_rad_s[i] = row.truth.rate_body_rad_s[i];
  }
  return packet;
}

void Session::finish() {
  send(last_sent_, PHOTORQUE_LAST);
}

Product Session::product() const {
  Product product = is_paced() ? clock_.product() : Product{};
  const auto put = [&](const std::string& name, uint64_t value) {
    product.quantities.push_back({name, {static_cast<double>(value), 0.0}});
  };
  if (!is_paced()) put("ticks", tick_ + 1);
  put("sessions", sessions_);
  if (is_paced()) put("silences_of_client", silences_);
  if (is_paced()) put("ticks_at_packet_limit", full_ticks_);
  put("packets_sent", sent_);
  put("packets_received", received_);
  put("packets_refused", gate_.total_refused());
  put("measurements_lost_by_link", to_client_.impairment().lost());
  put("commands_lost_by_link", from_client_.impairment().lost());
  put("commands_overtaken", overtaken_);
  if (!is_paced()) put("answers_that_came_twice", unanswered_);
  Table table = Table::of("refused", "Packets that were refused");
  for (size_t i = 0; i < refusal_names.size(); ++i) {
    table.row()
        .set("reason", refusal_names[i])
        .set("packets", static_cast<double>(gate_.refused()[i]));
  }
  product.tables.push_back(std::move(table));
  product.tables.push_back(events_);
  return product;
}

Key serve_table() {
  using namespace serve_key;
  return serve.of({mode, rate, address, port, wait_for_client, client_timeout, max_torque, silence,
                   hold, deadline, on_miss, spin, realtime_priority, send_truth,
                   to_client.of(link_keys()), from_client.of(link_keys())});
}

}  // namespace photorque
