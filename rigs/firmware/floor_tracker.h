/* U_min: the lowest S of a sliding window of about two minutes, kept as the minima of twelve buckets. Long
   enough to outlast beats down to 0.01 Hz; it rises again when the whole load rises. */
#ifndef FORCEGATE_FIRMWARE_FLOOR_TRACKER_H
#define FORCEGATE_FIRMWARE_FLOOR_TRACKER_H

#include <stdint.h>

#include "parameters.h"

typedef struct {
  int32_t bucket[FW_FLOOR_BUCKETS];
  uint32_t used; /* buckets that hold a value */
  uint32_t at;   /* the one being filled */
  uint32_t in_bucket;
  int32_t lowest;
} FwFloor;

void fw_floor_reset(FwFloor* floor, int32_t sum);
int32_t fw_floor_push(FwFloor* floor, int32_t sum);

#endif
