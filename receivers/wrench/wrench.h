// Force and torque of light on a body or a part of it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/wrench.h"
#include "raytrace/receiver.h"
#include "raytrace/scene.h"

namespace photorque {

// `kind = "wrench"`. Sums, over hits on the chosen instances, the momentum that surfaces take up:
// F = Σ force and T = Σ (r − p) × force. Both sides count. Bins: per instance, F [N] and T about
// `about_body_m` [N m], x, y, z each, in the body frame; first of the light straight from the
// emitters, then, in the same order, of the light that has met a surface before.
class WrenchReceiver final : public Receiver {
 public:
  WrenchReceiver(std::string name, const Scene& scene, std::vector<uint32_t> instances,
                 const Vec3& about_body_m = Vec3::Zero());

  size_t bins() const override;
  // Entries of direct light, at the front of bins().
  size_t direct_entries() const { return bins() / 2; }
  void score(const Hits& hits, std::span<double> sums) const override;
  // Quantities "force_x_NAME_body_N" … "torque_z_NAME_body_N_m", and the table "wrench_NAME" with a
  // row per part and a last row "total".
  Product product(const BinSums& sums) const override;

  // On all chosen instances together, and on each of them.
  WrenchEstimate total(const BinSums& sums) const;
  std::vector<WrenchEstimate> by_part(const BinSums& sums) const;
  // On all of them by direct light alone, and by bounced light.
  WrenchEstimate direct(const BinSums& sums) const;
  WrenchEstimate bounced(const BinSums& sums) const;

  // One for each chosen instance: its node, made unique by its path, material or number.
  const std::vector<std::string>& part_names() const { return part_names_; }
  const std::string& name() const { return name_; }
  const Vec3& about_body_m() const { return about_body_m_; }
  // Its number among the chosen, or none.
  std::optional<size_t> part_of(uint32_t instance) const {
    const size_t part = part_of_instance_[instance];
    return part < part_names_.size() ? std::optional(part) : std::nullopt;
  }

 private:
  WrenchEstimate estimate(const BinSums& sums, const std::function<bool(size_t)>& counts) const;

  std::string name_;
  Vec3 about_body_m_;
  std::vector<std::string> part_names_;
  std::vector<uint32_t> part_of_instance_;  // or the number of parts, for those not chosen
};

// The six headline figures of a wrench, named by its frame: "force_x_NAME_lab_N".
std::vector<Quantity> wrench_quantities(const WrenchEstimate& wrench, const std::string& name);

// Wrenches of named parts as a table "wrench_NAME", components and standard errors in columns.
Table wrench_rows(const std::vector<WrenchEstimate>& wrenches,
                  const std::vector<std::string>& names, const std::string& name);

}  // namespace photorque
