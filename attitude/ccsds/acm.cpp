#include "attitude/ccsds/acm.h"

#include "core/errors.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

class AcmReader {
 public:
  explicit AcmReader(const std::filesystem::path& path) : path_(path) {
    acm_.message = read_kvn(path);
  }

  AttitudeComprehensive read() {
    required(acm_.message, "CCSDS_ACM_VERS");
    for (const KvnItem& item : acm_.message.items) {
      if (item.kind != KvnItem::Kind::block) continue;
      if (item.key == "META") acm_.epoch_of_zero = required(item, "EPOCH_TZERO");
      if (item.key == "ATT") read_attitude(item);
      if (item.key == "PHYS") read_physical(item);
    }
    return std::move(acm_);
  }

 private:
  std::string required(const KvnItem& block, const char* name) const {
    const std::string* value = block.find(name);
    if (value == nullptr) {
      throw InputError({path_.string(), block.line}, name, "nothing", "a value");
    }
    return *value;
  }

  double number(const KvnItem& block, const char* name, const char* unit) const {
    for (const KvnItem& item : block.items) {
      if (item.kind != KvnItem::Kind::assignment || item.key != name) continue;
      if (!item.unit.empty() && item.unit != unit) {
        throw InputError({path_.string(), item.line}, name, "the unit " + item.unit, unit);
      }
      const std::vector<double> numbers = kvn_numbers(words_of(item.value), 0, path_, item.line);
      if (numbers.size() == 1) return numbers.front();
    }
    throw InputError({path_.string(), block.line}, name, "nothing", "one number");
  }

  void read_attitude(const KvnItem& block) {
    AttitudeComprehensive::AttitudeBlock attitude;
    attitude.frame_a = required(block, "REF_FRAME_A");
    attitude.frame_b = required(block, "REF_FRAME_B");
    attitude.type = required(block, "ATT_TYPE");
    if (const std::string* rate = block.find("RATE_TYPE")) attitude.rate_type = *rate;
    if (const std::string* euler = block.find("EULER_ROT_SEQ")) attitude.euler_sequence = *euler;
    constexpr int most_states = 100;
    const size_t states =
        require_count(number(block, "NUMBER_STATES", ""), {path_.string(), block.line},
                      "NUMBER_STATES", 1, most_states);
    for (const KvnItem& item : block.items) {
      if (item.kind != KvnItem::Kind::data) continue;
      std::vector<double> row = kvn_numbers(words_of(item.value), 0, path_, item.line);
      if (row.size() != states + 1) {
        throw InputError({path_.string(), item.line}, "", std::to_string(row.size()) + " numbers",
                         "a time and " + std::to_string(states) + " states");
      }
      attitude.time_s.push_back(row.front());
      row.erase(row.begin());
      attitude.values.push_back(std::move(row));
    }
    acm_.attitudes.push_back(std::move(attitude));
  }

  void read_physical(const KvnItem& block) {
    if (block.find("WET_MASS") != nullptr) acm_.wet_mass_kg = number(block, "WET_MASS", "kg");
    if (block.find("IXX") == nullptr) return;
    const auto moment = [&](const char* name) { return number(block, name, "kg*m**2"); };
    // The book's products of inertia are the matrix's elements, signs included.
    const double xy = moment("IXY"), xz = moment("IXZ"), yz = moment("IYZ");
    Mat3 inertia;
    inertia << moment("IXX"), xy, xz, xy, moment("IYY"), yz, xz, yz, moment("IZZ");
    acm_.inertia_kg_m2 = inertia;
  }

  std::filesystem::path path_;
  AttitudeComprehensive acm_;
};

}  // namespace

std::vector<Quat> AttitudeComprehensive::AttitudeBlock::quaternions() const {
  if (type != "QUATERNION") throw InputError({}, "ATT_TYPE", type, "QUATERNION");
  std::vector<Quat> all;
  for (const std::vector<double>& v : values) {
    if (v.size() < 4) throw InputError({}, "NUMBER_STATES", std::to_string(v.size()), "4 or more");
    all.push_back(Quat(v[3], v[0], v[1], v[2]).normalized());
  }
  return all;
}

AttitudeComprehensive read_acm(const std::filesystem::path& path) {
  return AcmReader(path).read();
}

void write_acm(const std::filesystem::path& path, const AttitudeComprehensive& acm) {
  write_kvn(path, acm.message);
}

}  // namespace photorque
