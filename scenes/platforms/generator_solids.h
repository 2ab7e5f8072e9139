// Triangle meshes of simple solids, and their masses.
//
// Every solid is watertight with shared vertices (each edge belongs to exactly two triangles, once
// in each direction) and its normals point outwards. Circles become polygons of the same area, so
// that volumes are those of the true solids: exactly where the profile is made of straight lines,
// and for spheres by a factor on the radii.
#pragma once

#include <span>

#include "core/transform.h"
#include "raytrace/scene.h"

namespace photorque {

// Centred on the origin, edges along the axes, lengths > 0.
Mesh box_solid(const Vec3& size_m);

// A rectangle facing +z, centred on the origin; no solid: it has no volume and no mass. Texture
// coordinates run over x and y from 0 to 1.
Mesh sheet(const Vec2& size_m);

// A box with a round hole along z through its centre; 0 < hole radius < half of the smaller side.
Mesh box_with_hole_solid(const Vec3& size_m, double hole_radius_m, int segments);

// A frustum about z, centred at half its height; radii ≥ 0, not both 0; `inner_radius_m` > 0 bores
// it from end to end.
Mesh cylinder_solid(double bottom_radius_m, double top_radius_m, double height_m,
                    double inner_radius_m, int segments);

// The part of a ball about the origin between the planes z = low and z = high,
// −radius ≤ low < high ≤ radius.
Mesh ball_solid(double radius_m, double low_m, double high_m, int segments);

// A spherical shell about the origin, open above the plane z = high; −inner radius < high < inner
// radius.
Mesh shell_solid(double outer_radius_m, double thickness_m, double high_m, int segments);

// A paraboloid sheet z = r²/(4 f) from its vertex at the origin to the rim, thickness measured
// downwards along z.
Mesh dish_solid(double rim_radius_m, double focal_length_m, double thickness_m, int segments);

// The solid that a closed profile in the half plane (r ≥ 0, z) sweeps about z. Counter-clockwise
// with r to the right and z up; no crossing.
Mesh revolved_solid(std::span<const Vec2> profile_m, int segments);

// Integrals over the inside of a closed mesh, exact for its triangles.
// Source: J. Blow, A. Binstock, "How to find the inertia tensor (or other mass properties) of a 3D
// solid body represented by a triangle mesh" (2004).
struct SolidMoments {
  double volume_m3 = 0.0;         // ∫ dV
  Vec3 first_m4 = Vec3::Zero();   // ∫ x dV
  Mat3 second_m5 = Mat3::Zero();  // ∫ x xᵀ dV
};
SolidMoments moments_of(const Mesh& mesh);

// Mass, centre of mass and inertia about the origin of one frame.
struct MassProperties {
  double mass_kg = 0.0;
  Vec3 centre_m = Vec3::Zero();
  Mat3 inertia_kg_m2 = Mat3::Zero();  // about the origin of the frame, not about the centre
};

// A homogeneous solid of this mass, placed in another frame.
MassProperties mass_properties(const SolidMoments& part_moments, double mass_kg,
                               const RigidTransform& body_from_part);

// Two bodies as one, in their common frame.
MassProperties operator+(const MassProperties& a, const MassProperties& b);

}  // namespace photorque
