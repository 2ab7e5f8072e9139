// The parts of `serve`: accepted packets, links, deadlines.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "core/errors.h"
#include "core/numerics/random.h"
#include "tests/tools/command_test.h"
#include "tools/realtime/clock.h"
#include "tools/realtime/gate.h"
#include "tools/realtime/link.h"

namespace photorque {
namespace {

constexpr uint64_t this_run = 77;
constexpr int64_t second_ns = 1'000'000'000;

std::span<const std::byte> bytes_of(const photorque_command_packet& packet) {
  return std::as_bytes(std::span(&packet, 1));
}
std::span<const std::byte> bytes_of(const photorque_header& header) {
  return std::as_bytes(std::span(&header, 1));
}

photorque_header header_of(uint16_t kind, uint64_t sequence, uint64_t run = this_run) {
  photorque_header header{};
  header.sequence = sequence;
  header.run = run;
  photorque_seal(&header, kind, sizeof header);
  return header;
}

photorque_command_packet command_of(uint64_t sequence, double torque_N_m, uint64_t run = this_run) {
  photorque_command_packet packet{};
  packet.header.sequence = sequence;
  packet.header.run = run;
  packet.torque_body_N_m[1] = torque_N_m;
  photorque_seal(&packet.header, PHOTORQUE_COMMAND, sizeof packet);
  return packet;
}

Gate gate_with_client() {
  Gate gate(this_run, 0.5, 2 * second_ns);
  EXPECT_TRUE(gate.admit(bytes_of(header_of(PHOTORQUE_HELLO, 1, 0)), 5, 0));
  return gate;
}

uint64_t refused(const Gate& gate, Refusal why) {
  return gate.refused()[static_cast<size_t>(why)];
}

// zlib's documentation: the CRC-32 of "123456789" is 0xcbf43926; the field of the checksum itself
// counts as zero.
TEST(Packets, ChecksumIsThatOfZlib) {
  EXPECT_EQ(photorque_checksum("123456789", 9), 0xcbf43926u);
  photorque_command_packet packet = command_of(3, 0.1);
  const uint32_t sum = packet.header.checksum;
  packet.header.checksum = 12345;
  EXPECT_EQ(photorque_checksum(&packet, sizeof packet), sum);
}

TEST(Packets, AMillionOfNonsenseAreRefused) {
  Gate gate = gate_with_client();
  const photorque_command_packet good = command_of(2, 0.1);
  constexpr uint64_t count = 1'000'000;
  std::array<std::byte, 128> bytes{};
  for (uint64_t i = 0; i < count; ++i) {
    uint64_t word = hash_words(9, i);
    size_t size = 0;
    if (i % 2 == 0) {
      // Bytes by chance, a quarter of them with a true beginning.
      size = word % bytes.size();
      for (size_t k = 0; k < bytes.size(); k += 8) {
        const uint64_t part = hash_words(10, i, k);
        std::memcpy(bytes.data() + k, &part, 8);
      }
      if (i % 8 == 0) std::memcpy(bytes.data(), &good, 12);
    } else {
      // A good packet with one to six bits turned, some cut or longer as well.
      size = sizeof good;
      std::memcpy(bytes.data(), &good, size);
      for (uint64_t k = 0; k <= word % 6; ++k) {
        const uint64_t at = hash_words(11, i, k) % (8 * sizeof good);
        bytes[at / 8] ^= std::byte{static_cast<unsigned char>(1u << (at % 8))};
      }
      if (i % 16 == 1) size = (word >> 8) % bytes.size();
      // One bit flipped twice leaves the packet good.
      if (size == sizeof good && std::memcmp(bytes.data(), &good, size) == 0)
        bytes[20] ^= std::byte{1};
    }
    ASSERT_FALSE(gate.admit(std::span(bytes).first(size), 5, 0)) << i;
  }
  EXPECT_EQ(gate.total_refused(), count);
  EXPECT_GT(refused(gate, Refusal::checksum), count / 5);
  EXPECT_GT(refused(gate, Refusal::magic), count / 8);
  EXPECT_GT(refused(gate, Refusal::size), 0u);
  EXPECT_GT(refused(gate, Refusal::version), 0u);
  EXPECT_GT(refused(gate, Refusal::kind), 0u);
  const auto admitted = gate.admit(bytes_of(good), 5, 0);
  ASSERT_TRUE(admitted);
  EXPECT_EQ(admitted->command.torque_body_N_m[1], 0.1);
}

TEST(Packets, AreRejectedForTheirContent) {
  Gate gate = gate_with_client();
  const auto admitted = [&](const auto& packet, uint64_t sender = 5, int64_t now_ns = 0) {
    return gate.admit(bytes_of(packet), sender, now_ns).has_value();
  };
  EXPECT_TRUE(admitted(command_of(5, 0.5)));
  EXPECT_FALSE(admitted(command_of(5, 0.5)));
  EXPECT_FALSE(admitted(command_of(4, 0.5)));
  EXPECT_EQ(refused(gate, Refusal::old), 2u);
  EXPECT_FALSE(admitted(command_of(6, std::nan(""))));
  EXPECT_FALSE(admitted(command_of(6, HUGE_VAL)));
  EXPECT_EQ(refused(gate, Refusal::not_finite), 2u);
  EXPECT_FALSE(admitted(command_of(6, 0.51)));
  EXPECT_EQ(refused(gate, Refusal::too_large), 1u);
  EXPECT_FALSE(admitted(command_of(6, 0.1, this_run + 1)));
  EXPECT_EQ(refused(gate, Refusal::run), 1u);
  EXPECT_FALSE(admitted(command_of(6, 0.1), 6));
  EXPECT_FALSE(admitted(header_of(PHOTORQUE_HELLO, 1, 0), 6));
  EXPECT_EQ(refused(gate, Refusal::stranger), 2u);
  EXPECT_FALSE(admitted(header_of(PHOTORQUE_MEASUREMENT, 6)));
  EXPECT_EQ(refused(gate, Refusal::kind), 1u);
  EXPECT_EQ(gate.client(), 5u);
  // After two seconds of silence another may come; after a goodbye at once.
  EXPECT_TRUE(admitted(header_of(PHOTORQUE_HELLO, 1, 0), 6, 3 * second_ns));
  EXPECT_EQ(gate.client(), 6u);
  EXPECT_TRUE(admitted(header_of(PHOTORQUE_GOODBYE, 2), 6, 3 * second_ns));
  EXPECT_TRUE(admitted(header_of(PHOTORQUE_HELLO, 1, 0), 5, 3 * second_ns));
}

// Packets before the hello are ignored, from another address or from an earlier program at the same
// address. A repeated hello starts no session.
TEST(Packets, ASessionBeginsWithItsHello) {
  Gate gate(this_run, 0.5, 2 * second_ns);
  const photorque_header hello = header_of(PHOTORQUE_HELLO, 1, 0);
  EXPECT_TRUE(gate.admit(bytes_of(hello), 5, 0)->begins_session);
  EXPECT_FALSE(gate.admit(bytes_of(hello), 5, 0)->begins_session);
  EXPECT_TRUE(gate.admit(bytes_of(command_of(900, 0.1)), 5, 0));
  EXPECT_FALSE(gate.is_silent(2 * second_ns));
  EXPECT_TRUE(gate.is_silent(2 * second_ns + 1));
  EXPECT_TRUE(gate.admit(bytes_of(hello), 6, 3 * second_ns)->begins_session);
  EXPECT_TRUE(gate.admit(bytes_of(command_of(2, 0.1)), 6, 3 * second_ns));
  EXPECT_TRUE(gate.admit(bytes_of(hello), 6, 3 * second_ns)->begins_session);
  EXPECT_TRUE(gate.admit(bytes_of(command_of(2, 0.1)), 6, 3 * second_ns));
}

struct Fates {
  std::vector<double> delays_s;  // NaN: lost
  double lost = 0.0;             // fraction
};

Fates fates(const LinkSettings& settings, int count) {
  LinkImpairment impairment(settings, 4, 1);
  Fates all;
  for (int i = 0; i < count; ++i) {
    all.delays_s.push_back(impairment.next().value_or(std::nan("")));
  }
  all.lost = static_cast<double>(impairment.lost()) / count;
  return all;
}

// Means and standard deviations of the three distributions, within 4.5 standard errors.
TEST(Link, DelaysHaveTheirDistribution) {
  struct Row {
    LinkSettings::Jitter jitter;
    double mean, deviation;  // of the part beyond the least delay, in units of jitter_s
  };
  constexpr int count = 200000;
  for (const Row& row :
       {Row{LinkSettings::Jitter::exponential, 1.0, 1.0},
        Row{LinkSettings::Jitter::uniform, 0.5, std::sqrt(1.0 / 12.0)},
        Row{LinkSettings::Jitter::gaussian, std::sqrt(2.0 / M_PI), std::sqrt(1.0 - 2.0 / M_PI)}}) {
    LinkSettings settings;
    settings.delay_s = 0.004;
    settings.jitter_s = 0.002;
    settings.jitter = row.jitter;
    double sum = 0.0, squares = 0.0;
    for (const double delay_s : fates(settings, count).delays_s) {
      const double x = (delay_s - 0.004) / 0.002;
      ASSERT_GE(x, 0.0);
      sum += x;
      squares += (x - row.mean) * (x - row.mean);
    }
    EXPECT_NEAR(sum / count, row.mean, 4.5 * row.deviation / std::sqrt(count));
    EXPECT_NEAR(squares / count, row.deviation * row.deviation,
                4.5 * 3.0 * row.deviation * row.deviation / std::sqrt(count));
  }
}

// In the long run b/(b + e) of the packets lie in a burst (the stationary distribution of the
// two-state chain), which lasts 1/e packets on average.
TEST(Link, LosesAloneAndInBursts) {
  constexpr int count = 400000;
  LinkSettings alone;
  alone.loss = 0.05;
  EXPECT_NEAR(fates(alone, count).lost, 0.05, 4.5 * std::sqrt(0.05 * 0.95 / count));
  LinkSettings bursts;
  bursts.burst_begin = 0.01;
  bursts.burst_end = 0.2;
  const Fates seen = fates(bursts, count);
  // The variance of the mean is larger than of independent ones by (1 + r)/(1 − r), r = 1 − b − e.
  const double fraction = 0.01 / 0.21, correlation = 1.0 - 0.21;
  const double error =
      std::sqrt(fraction * (1.0 - fraction) / count * (1.0 + correlation) / (1.0 - correlation));
  EXPECT_NEAR(seen.lost, fraction, 4.5 * error);
  int begun = 0;
  for (size_t i = 1; i < seen.delays_s.size(); ++i) {
    begun += std::isnan(seen.delays_s[i]) && !std::isnan(seen.delays_s[i - 1]) ? 1 : 0;
  }
  EXPECT_NEAR(seen.lost * count / begun, 5.0, 4.5 * std::sqrt(20.0 / begun));
}

TEST(Link, FollowsAMeasuredTraceAndRepeats) {
  LinkSettings settings;
  settings.trace_s = {0.001, -1.0, 0.003};
  const Fates seen = fates(settings, 7);
  EXPECT_EQ(seen.delays_s[0], 0.001);
  EXPECT_TRUE(std::isnan(seen.delays_s[1]));
  EXPECT_EQ(seen.delays_s[2], 0.003);
  EXPECT_EQ(seen.delays_s[3], 0.001);
  EXPECT_NEAR(seen.lost, 2.0 / 7.0, 1e-12);
}

// With jitter packets overtake each other; without `reorder` none does, and each comes no earlier.
TEST(Link, PacketsOvertakeOnlyWhereTheyMay) {
  LinkSettings settings;
  settings.jitter_s = 0.01;
  SimulatedLink<int> free(settings, 1, 2);
  settings.reorder = false;
  SimulatedLink<int> orderly(settings, 1, 2);
  std::vector<int> seen_free, seen_orderly;
  for (int i = 0; i < 1000; ++i) {
    const double now_s = 0.001 * i;
    free.push(i, now_s);
    orderly.push(i, now_s);
    while (const auto packet = free.pop(now_s)) seen_free.push_back(*packet);
    while (const auto packet = orderly.pop(now_s)) seen_orderly.push_back(*packet);
  }
  EXPECT_FALSE(std::ranges::is_sorted(seen_free));
  EXPECT_TRUE(std::ranges::is_sorted(seen_orderly));
  EXPECT_GT(seen_orderly.size(), 900u);
  EXPECT_LE(seen_orderly.size(), seen_free.size());
  EXPECT_EQ(std::set<int>(seen_free.begin(), seen_free.end()).size(), seen_free.size());
}

double quantity(const Product& product, const std::string& name) {
  const Quantity* found = find_quantity(product, name);
  EXPECT_NE(found, nullptr) << name;
  return found != nullptr ? found->estimate.value : 0.0;
}

// A thousand ticks of a millisecond, the i-th late by i microseconds, and five by two steps.
TEST(TickClock, CountsMissesAndPercentiles) {
  const auto late_ns = [](size_t tick) {
    return tick % 200 == 199 ? int64_t{2'000'000} : static_cast<int64_t>(1000 * tick);
  };
  TickClock clock(1e-3, 1e-3, OnMiss::catch_up);
  clock.start(500);
  for (size_t i = 0; i < 1000; ++i) {
    ASSERT_EQ(clock.due_ns(i), 500 + static_cast<int64_t>(i) * 1'000'000);
    EXPECT_EQ(clock.served(i, clock.due_ns(i) + late_ns(i), 7000), i % 200 == 199);
  }
  const Product product = clock.product();
  EXPECT_EQ(quantity(product, "ticks_missed"), 5.0);
  EXPECT_NEAR(quantity(product, "lateness_p50_us"), 501.0, 1.5);
  EXPECT_NEAR(quantity(product, "lateness_p99_us"), 994.0, 1.5);
  EXPECT_NEAR(quantity(product, "lateness_largest_us"), 2000.0, 0.01);
  EXPECT_NEAR(quantity(product, "computing_p99_99_us"), 7.0, 1e-4);
}

TEST(TickClock, SlipsOrStops) {
  TickClock slipping(1e-3, 1e-3, OnMiss::slip);
  slipping.start(0);
  EXPECT_TRUE(slipping.served(1, 1'000'000 + 3'000'000, 0));
  EXPECT_EQ(slipping.due_ns(2), 2'000'000 + 3'000'000);
  EXPECT_NEAR(quantity(slipping.product(), "slipped_s"), 3e-3, 1e-12);
  TickClock stopping(1e-3, 1e-3, OnMiss::stop);
  stopping.start(0);
  EXPECT_FALSE(stopping.served(0, 900'000, 0));
  EXPECT_THROW(stopping.served(1, 2'100'000, 0), NumericalError);
}

}  // namespace
}  // namespace photorque
