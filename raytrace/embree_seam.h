// The only source that knows which major version of Embree is installed: 3 (contexts) or 4
// (arguments). PHOTORQUE_EMBREE_MAJOR comes from CMake.
#pragma once

#if PHOTORQUE_EMBREE_MAJOR == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace photorque {

// How alike the rays of a packet are; wrong advice costs speed, never correctness.
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

 private:
  RTCIntersectContext context_;
};
#endif

template <int Width>
struct PacketType;
template <>
struct PacketType<8> {
  using type = RTCRayHit8;
};
template <>
struct PacketType<16> {
  using type = RTCRayHit16;
};

}  // namespace embree_seam
}  // namespace photorque
