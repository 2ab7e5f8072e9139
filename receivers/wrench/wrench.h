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

// `kind = "wrench"`. Sums the momentum that surfaces take up over hits on the chosen instances:
// F = Σ force and T = Σ (r − p) × force. Both sides count. Bins: per instance, F [N] and T about
// `about_body_m` [N m], x, y, z each, in the body frame. The first half is light directly from the
// emitters, the second half, in the same order, light that has met a surface before.
class WrenchReceiver final : public Receiver {
 public:
  WrenchReceiver(std::string name, const Scene& scene, std::vector<uint32_t> instances,
                 const Vec3& about_body_m = Vec3::Zero());

  size_t bins() const override;
  // Number of bins of direct light; they are the first half of bins().
  size_t direct_entries() const { return bins() / 2; }
  void score(const Hits& hits, std::span<double> sums) const override;
  // Quantities "force_x_NAME_body_N", …, "torque_z_NAME_body_N_m", and the table "wrench_NAME" with
  // one row per part and a last row "total".
  Product product(const BinSums& sums) const override;

  // Wrench on all chosen instances together, and on each of them.
  WrenchEstimate total(const BinSums& sums) const;
  std::vector<WrenchEstimate> by_part(const BinSums& sums) const;
  // Wrench on all chosen instances from direct light only.
  WrenchEstimate direct(const BinSums& sums) const;

  // Names of the chosen instances: the node, made unique by path, material or number.
  const std::vector<std::string>& part_names() const { return part_names_; }
  const std::string& name() const { return name_; }
  const Vec3& about_body_m() const { return about_body_m_; }
  // Index among the chosen instances; empty if it is not one of them.
  std::optional<size_t> part_of(uint32_t instance) const {
    const size_t part = part_of_instance_[instance];
    return part < part_names_.size() ? std::optional(part) : std::nullopt;
  }

 private:
  WrenchEstimate estimate(const BinSums& sums, const std::function<bool(size_t)>& counts) const;

  std::string name_;
  Vec3 about_body_m_;
  std::vector<std::string> part_names_;
  std::vector<uint32_t> part_of_instance_;  // the number of parts for instances that are not chosen
};

// The six main quantities of a wrench, with its frame in the name: "force_x_NAME_lab_N".
std::vector<Quantity> wrench_quantities(const WrenchEstimate& wrench, const std::string& name);

// Wrenches of named parts as a table "wrench_NAME": components and standard errors in columns.
Table wrench_rows(const std::vector<WrenchEstimate>& wrenches,
                  const std::vector<std::string>& names, const std::string& name);

}  // namespace photorque
