// A simulated wireless link: packets can be late, reordered, or lost singly or in bursts.
//
// Every random number is a hash of the seed, the direction and the packet's number, so that equal
// packets are treated equally at any speed of the clock.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "core/settings/typed_keys.h"

namespace photorque {

struct LinkSettings {
  enum class Jitter { exponential, uniform, gaussian };
  double delay_s = 0.0;  // minimum delay of a packet
  // In addition: mean of an exponential, width of a uniform, or scale of a half-normal
  // distribution.
  double jitter_s = 0.0;
  Jitter jitter = Jitter::exponential;
  double loss = 0.0;  // fraction of lost packets, independent of each other
  // Bursts (E. N. Gilbert, Bell Syst. Tech. J. 39 (1960) 1253; E. O. Elliott, ibid. 42 (1963)
  // 1977): probability per packet that a burst begins, probability that it ends, and probability
  // that a packet in it is lost.
  double burst_begin = 0.0, burst_end = 1.0, burst_loss = 1.0;
  bool reorder = true;  // a packet may overtake another; otherwise it waits for earlier ones
  // Measured delays, used in turn instead of the above; negative: the packet was lost.
  std::vector<double> trace_s;
};

// Reads a table of link_keys(); its file of measured delays is relative to `folder`.
LinkSettings read_link(const Settings& settings, const std::filesystem::path& folder);
std::vector<Key> link_keys();

// Fates of successive packets on a link.
class LinkImpairment {
 public:
  LinkImpairment(LinkSettings settings, uint64_t seed, uint64_t stream);

  // Delay of the next packet [s]; empty if it is lost.
  std::optional<double> next();

  uint64_t sent() const { return sent_; }
  uint64_t lost() const { return lost_; }

 private:
  double draw(uint64_t dimension) const;
  double jitter_s() const;

  LinkSettings settings_;
  uint64_t seed_, stream_;
  uint64_t sent_ = 0, lost_ = 0;
  bool in_burst_ = false;
};

// Packets in transit. Times are those of the caller [s].
template <class Packet>
class SimulatedLink {
 public:
  SimulatedLink(LinkSettings settings, uint64_t seed, uint64_t stream)
      : keeps_order_(!settings.reorder), fate_(std::move(settings), seed, stream) {}

  // Sends a packet; it is lost or arrives after a random delay.
  void push(const Packet& packet, double now_s) {
    const std::optional<double> delay_s = fate_.next();
    if (!delay_s) return;
    double due_s = now_s + *delay_s;
    if (keeps_order_) due_s = std::max(due_s, last_due_s_);
    last_due_s_ = due_s;
    on_the_way_.emplace(due_s, packet);  // behind packets of the same time
  }
  // The next packet that has arrived by `now_s`, in order of arrival.
  std::optional<Packet> pop(double now_s) {
    if (on_the_way_.empty() || next_due_s() > now_s) return {};
    return on_the_way_.extract(on_the_way_.begin()).mapped();
  }
  // Arrival time of the next packet; infinity if none is in transit.
  double next_due_s() const {
    return on_the_way_.empty() ? std::numeric_limits<double>::infinity()
                               : on_the_way_.begin()->first;
  }
  // Discards all packets in transit.
  void clear() { on_the_way_.clear(); }
  const LinkImpairment& impairment() const { return fate_; }

 private:
  bool keeps_order_;
  LinkImpairment fate_;
  double last_due_s_ = -std::numeric_limits<double>::infinity();
  std::multimap<double, Packet> on_the_way_;  // by time of arrival
};

}  // namespace photorque
