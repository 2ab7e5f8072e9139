#include "raytrace/scene.h"

#include <algorithm>

namespace photorque {

Eigen::AlignedBox3d Scene::box_of(const Instance& instance) const {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : meshes[instance.mesh].vertices_m) {
    box.extend(instance.body_from_mesh * vertex);
  }
  return box;
}

Eigen::AlignedBox3d Scene::box() const {
  Eigen::AlignedBox3d all;
  for (const Instance& instance : instances) all.extend(box_of(instance));
  return all;
}

double Scene::radius_m() const {
  double square = 0.0;
  for (const Instance& instance : instances) {
    for (const Vec3& vertex : meshes[instance.mesh].vertices_m) {
      square = std::max(square, (instance.body_from_mesh * vertex).squaredNorm());
    }
  }
  return std::sqrt(square);
}

std::vector<uint32_t> Scene::instances_of(const std::string& name) const {
  // Between slashes, a name matches whole path components only, at any depth.
  const std::string wanted = "/" + name + "/";
  std::vector<uint32_t> found;
  for (uint32_t i = 0; i < instances.size(); ++i) {
    if (("/" + instances[i].path + "/").find(wanted) != std::string::npos) found.push_back(i);
  }
  return found;
}

}  // namespace photorque
