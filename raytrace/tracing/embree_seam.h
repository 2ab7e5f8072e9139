// The only source file that depends on the installed major version of Embree: 3 (contexts) or 4
// (arguments). CMake defines PHOTORQUE_EMBREE_MAJOR.
#pragma once

#if PHOTORQUE_EMBREE_MAJOR == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>

namespace photorque {

// Similarity of the rays of a packet. It affects only the speed.
enum class Coherence { coherent, incoherent };

namespace embree_seam {

#if PHOTORQUE_EMBREE_MAJOR == 4
class Query {
 public:
  explicit Query(Coherence coherence) {
    rtcInitIntersectArguments(&arguments_);
    arguments_.flags = coherence == Coherence::coherent ? RTC_RAY_QUERY_FLAG_COHERENT
                                                        : RTC_RAY_QUERY_FLAG_INCOHERENT;
  }
  void intersect(RTCScene scene, const int* valid, RTCRayHit8& rays) {
    rtcIntersect8(valid, scene, &rays, &arguments_);
  }
  void intersect(RTCScene scene, const int* valid, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &rays, &arguments_);
  }
  // Sets tfar of every occluded ray to −∞.
  static void occluded(RTCScene scene, const int* valid, RTCRay8& rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    rtcOccluded8(valid, scene, &rays, &arguments);
  }
  static void occluded(RTCScene scene, const int* valid, RTCRay16& rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    rtcOccluded16(valid, scene, &rays, &arguments);
  }

 private:
  RTCIntersectArguments arguments_;
};
#else
class Query {
 public:
  explicit Query(Coherence coherence) {
    rtcInitIntersectContext(&context_);
    context_.flags = coherence == Coherence::coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                      : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  void intersect(RTCScene scene, const int* valid, RTCRayHit8& rays) {
    rtcIntersect8(valid, scene, &context_, &rays);
  }
  void intersect(RTCScene scene, const int* valid, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &context_, &rays);
  }
  // Sets tfar of every occluded ray to −∞.
  static void occluded(RTCScene scene, const int* valid, RTCRay8& rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(valid, scene, &context, &rays);
  }
  static void occluded(RTCScene scene, const int* valid, RTCRay16& rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, scene, &context, &rays);
  }

 private:
  RTCIntersectContext context_;
};
#endif

template <int Width>
struct PacketType;
template <>
struct PacketType<8> {
  using type = RTCRayHit8;
  using shadow = RTCRay8;
};
template <>
struct PacketType<16> {
  using type = RTCRayHit16;
  using shadow = RTCRay16;
};

// Sets the members that are equal for all rays.
template <int Width, class Packet>
void initialise(Packet& packet) {
  std::fill_n(packet.tnear, Width, 0.0f);
  std::fill_n(packet.time, Width, 0.0f);
  std::fill_n(packet.mask, Width, ~0u);
  std::fill_n(packet.id, Width, 0u);
  std::fill_n(packet.flags, Width, 0u);
}

}  // namespace embree_seam
}  // namespace photorque
