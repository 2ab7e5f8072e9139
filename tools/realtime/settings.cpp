#include "tools/realtime/settings.h"

#include <limits>

#include "attitude/propagation/run.h"
#include "tools/realtime/photorque_serve.h"

namespace photorque {
ServeSettings read_serve(const Settings& root) {
  const Settings s = own_table(root, "serve", false);
  ServeSettings serve;
  serve.mode = static_cast<ServeSettings::Mode>(s.choice_or("mode", {"paced", "lockstep"}, 0));
  serve.rate_Hz = s.number_or("rate_Hz", serve.rate_Hz, {0.1, 1e5});
  serve.address = s.text_or("address", serve.address);
  serve.port = static_cast<int>(s.integer_or("port", PHOTORQUE_PORT, 0, 65535));
  serve.wait_for_client = s.flag_or("wait_for_client", true);
  serve.client_timeout_s = s.number_or("client_timeout_s", serve.client_timeout_s, {1e-3, 1e6});
  serve.max_torque_N_m = s.number_or("max_torque_N_m", serve.max_torque_N_m, Range::positive());
  serve.hold_s = s.number_or("hold_s", std::numeric_limits<double>::infinity(), Range::positive());
  serve.deadline_s = s.number_or("deadline_s", 1.0 / serve.rate_Hz, Range::positive());
  serve.on_miss = static_cast<OnMiss>(s.choice_or("on_miss", {"catch_up", "slip", "stop"}, 0));
  serve.spin_s = s.number_or("spin_s", serve.spin_s, {0.0, 1.0});
  serve.realtime_priority = static_cast<int>(s.integer_or("realtime_priority", 0, 0, 99));
  serve.send_truth = s.flag_or("send_truth", false);
  const auto folder = std::filesystem::path(root.where().file).parent_path();
  if (s.has("to_client")) serve.to_client = read_link(s.table("to_client"), folder);
  if (s.has("from_client")) serve.from_client = read_link(s.table("from_client"), folder);
  s.finish();
  return serve;
}

}  // namespace photorque
