#include "floor_tracker.h"

void fw_floor_reset(FwFloor* f, int32_t sum) {
  f->used = 1;
  f->at = 0;
  f->in_bucket = 0;
  f->bucket[0] = sum;
  f->lowest = sum;
}

int32_t fw_floor_push(FwFloor* f, int32_t sum) {
  if (f->in_bucket == FW_FLOOR_BUCKET_SAMPLES) {
    f->in_bucket = 0;
    f->at = (f->at + 1u) % FW_FLOOR_BUCKETS;
    if (f->used < FW_FLOOR_BUCKETS) ++f->used;
    f->bucket[f->at] = sum;
    f->lowest = sum;
    for (uint32_t i = 0; i < f->used; ++i)
      if (f->bucket[i] < f->lowest) f->lowest = f->bucket[i];
  }
  ++f->in_bucket;
  if (sum < f->bucket[f->at]) f->bucket[f->at] = sum;
  if (sum < f->lowest) f->lowest = sum;
  return f->lowest;
}
