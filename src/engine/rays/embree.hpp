// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Includes Embree 3 or 4, whichever cmake/dependencies.cmake finds; both look for version 4 first. All
// differences between their interfaces are handled in this file.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace tubefoot {

/// Finds the first hit of a ray.
inline void first_hit(RTCScene scene, RTCRayHit& ray) {
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect1(scene, &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
#endif
}

/// Finds the first hits of the valid rays among sixteen rays of similar direction.
inline void first_hits(const int* valid, RTCScene scene, RTCRayHit16& rays) {
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments how;
  rtcInitIntersectArguments(&how);
  how.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &rays, &how);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &context, &rays);
#endif
}

}  // namespace tubefoot
