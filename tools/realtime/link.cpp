#include "tools/realtime/link.h"

#include <cmath>
#include <filesystem>

#include "core/constants.h"
#include "core/numerics/random.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

namespace link_key {
constexpr Range up_to_an_hour{0.0, 3600.0};
constexpr NumberKey delay("delay_s", 0.0, up_to_an_hour, "minimum delay of a packet");
constexpr NumberKey jitter("jitter_s", 0.0, up_to_an_hour,
                           "additional delay, distributed according to `jitter`");
constexpr ChoiceKey jitter_law("jitter",
                               {{"exponential", "of this mean"},
                                {"uniform", "up to this"},
                                {"gaussian", "the absolute value of one of this scale"}},
                               0, "distribution of the delay");
constexpr NumberKey loss("loss", 0.0, Range::fraction(),
                         "fraction of packets that are lost independently of each other");
constexpr NumberKey burst_begin(
    "burst_begin", 0.0, Range::fraction(),
    "Gilbert and Elliott's two states: probability per packet that a burst begins");
constexpr NumberKey burst_end("burst_end", 1.0, {0.0, 1.0, true, false},
                              "probability per packet that the burst ends");
constexpr NumberKey burst_loss("burst_loss", 1.0, Range::fraction(),
                               "probability that a packet of a burst is lost");
constexpr FlagKey reorder("reorder", true, "packets may overtake each other");
constexpr TextKey trace(
    "trace",
    "CSV file with the column `delay_s`: measured delays that are used in turn instead (−1: lost)",
    {.usually = "none"});
}  // namespace link_key

enum LinkDraw : uint64_t { lost_alone, burst_changes, lost_in_burst, jitter_u, jitter_v };

std::vector<double> read_trace(const Settings& settings, const std::filesystem::path& folder) {
  const std::string name = settings.get(link_key::trace);
  const std::filesystem::path path = folder / name;
  if (!std::filesystem::is_regular_file(path)) {
    throw settings.error(link_key::trace, "\"" + name + "\"", "a file beside the experiment");
  }
  const NumberColumns file = read_number_columns(path, {"delay_s"});
  if (std::ranges::all_of(file.columns[0], [](double d) { return d < 0.0; })) {
    throw settings.error(link_key::trace, "no packet that arrives",
                         "delays in seconds, -1 where lost");
  }
  return file.columns[0];
}

}  // namespace

LinkSettings read_link(const Settings& settings, const std::filesystem::path& folder) {
  LinkSettings link;
  link.delay_s = settings.get(link_key::delay);
  link.jitter_s = settings.get(link_key::jitter);
  link.jitter = static_cast<LinkSettings::Jitter>(settings.get(link_key::jitter_law));
  link.loss = settings.get(link_key::loss);
  link.burst_begin = settings.get(link_key::burst_begin);
  link.burst_end = settings.get(link_key::burst_end);
  link.burst_loss = settings.get(link_key::burst_loss);
  link.reorder = settings.get(link_key::reorder);
  if (settings.has(link_key::trace)) link.trace_s = read_trace(settings, folder);
  return link;
}

LinkImpairment::LinkImpairment(LinkSettings settings, uint64_t seed, uint64_t stream)
    : settings_(std::move(settings)), seed_(seed), stream_(stream) {}

double LinkImpairment::draw(uint64_t dimension) const {
  return unit_interval(hash_words(seed_, stream_, sent_, dimension));
}

double LinkImpairment::jitter_s() const {
  if (settings_.jitter_s == 0.0) return 0.0;
  const double u = draw(jitter_u);
  switch (settings_.jitter) {
    case LinkSettings::Jitter::exponential:
      return -settings_.jitter_s * std::log(u);
    case LinkSettings::Jitter::uniform:
      return settings_.jitter_s * u;
    case LinkSettings::Jitter::gaussian:
      // Method: Box and Muller, Ann. Math. Stat. 29 (1958) 610.
      return settings_.jitter_s *
             std::abs(std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * pi * draw(jitter_v)));
  }
  return 0.0;
}

std::optional<double> LinkImpairment::next() {
  std::optional<double> delay_s;
  if (!settings_.trace_s.empty()) {
    const double measured_s = settings_.trace_s[sent_ % settings_.trace_s.size()];
    if (measured_s >= 0.0) delay_s = measured_s;
  } else {
    if (draw(burst_changes) < (in_burst_ ? settings_.burst_end : settings_.burst_begin)) {
      in_burst_ = !in_burst_;
    }
    const bool is_lost = draw(lost_alone) < settings_.loss ||
                         (in_burst_ && draw(lost_in_burst) < settings_.burst_loss);
    if (!is_lost) delay_s = settings_.delay_s + jitter_s();
  }
  ++sent_;
  if (!delay_s) ++lost_;
  return delay_s;
}

std::vector<Key> link_keys() {
  using namespace link_key;
  return {delay,     jitter,     jitter_law, loss,           burst_begin,
          burst_end, burst_loss, reorder,    link_key::trace};
}

}  // namespace photorque
