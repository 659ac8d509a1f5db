#include "spectrum.h"

#include <string.h>

/* round(2^14 sin(pi/2 i / 128)) */
static const int16_t kQuarterSine[129] = {
    0,     201,   402,   603,   804,   1005,  1205,  1406,  1606,  1806,  2006,  2205,  2404,  2603,  2801,
    2999,  3196,  3393,  3590,  3786,  3981,  4176,  4370,  4563,  4756,  4948,  5139,  5330,  5520,  5708,
    5897,  6084,  6270,  6455,  6639,  6823,  7005,  7186,  7366,  7545,  7723,  7900,  8076,  8250,  8423,
    8595,  8765,  8935,  9102,  9269,  9434,  9598,  9760,  9921,  10080, 10238, 10394, 10549, 10702, 10853,
    11003, 11151, 11297, 11442, 11585, 11727, 11866, 12004, 12140, 12274, 12406, 12537, 12665, 12792, 12916,
    13039, 13160, 13279, 13395, 13510, 13623, 13733, 13842, 13949, 14053, 14155, 14256, 14354, 14449, 14543,
    14635, 14724, 14811, 14896, 14978, 15059, 15137, 15213, 15286, 15357, 15426, 15493, 15557, 15619, 15679,
    15736, 15791, 15843, 15893, 15941, 15986, 16029, 16069, 16107, 16143, 16176, 16207, 16235, 16261, 16284,
    16305, 16324, 16340, 16353, 16364, 16373, 16379, 16383, 16384,
};

static int32_t sine(uint32_t phase) { /* phase in 1/512 of a turn */
  phase &= 511u;
  const uint32_t in_half = phase & 255u;
  const int32_t value = kQuarterSine[in_half <= 128u ? in_half : 256u - in_half];
  return phase < 256u ? value : -value;
}

static uint64_t hann_power(const FwSpectrum* s, uint32_t k) {
  const int64_t below_re = k > 1u ? s->re[k - 1u] : 0;
  const int64_t below_im = k > 1u ? s->im[k - 1u] : 0;
  const int64_t re = (2 * s->re[k] - below_re - s->re[k + 1u]) >> 20;
  const int64_t im = (2 * s->im[k] - below_im - s->im[k + 1u]) >> 20;
  return (uint64_t)(re * re) + (uint64_t)(im * im);
}

static void spread(FwSpectrum* s) {
  for (int i = 0; i < 3 && s->next_bin <= FW_SPECTRUM_BINS; ++i, ++s->next_bin) {
    const uint32_t k = s->next_bin;
    const uint32_t phase = k * s->latched_index;
    s->re[k] += (int64_t)s->latched * sine(phase + 128u);
    s->im[k] -= (int64_t)s->latched * sine(phase);
  }
  if (s->next_bin > FW_SPECTRUM_BINS) {
    if (s->latched_index == FW_SPECTRUM_POINTS - 1) {
      s->stage = 1;
      s->next_bin = 1;
    }
    s->latched_index = FW_SPECTRUM_POINTS;
  }
}

void fw_spectrum_reset(FwSpectrum* s) {
  memset(s, 0, sizeof *s);
  s->latched_index = FW_SPECTRUM_POINTS;
}

void fw_spectrum_push(FwSpectrum* s, uint16_t code) {
  if (s->stage == 0) {
    if (s->latched_index < FW_SPECTRUM_POINTS) spread(s);
    if (s->blocks < FW_SPECTRUM_POINTS) {
      s->block_sum += code;
      if (++s->in_block == FW_SPECTRUM_DECIMATION) {
        s->latched = s->block_sum;
        s->latched_index = s->blocks++;
        s->next_bin = 1;
        s->block_sum = 0;
        s->in_block = 0;
      }
    }
  } else if (s->stage == 1) {
    const uint64_t power = hann_power(s, s->next_bin);
    s->power[s->next_bin] = power;
    if (power > s->power_max) s->power_max = power;
    if (++s->next_bin == FW_SPECTRUM_BINS) {
      s->stage = 2;
      s->next_bin = 1;
    }
  } else if (s->stage == 2) {
    const uint32_t k = s->next_bin++;
    const uint64_t above = k + 1u < FW_SPECTRUM_BINS ? s->power[k + 1u] : 0;
    const uint64_t below = s->power[k - 1u];
    if (s->power[k] * FW_LINE_POWER_DIVISOR >= s->power_max && s->power[k] >= below && s->power[k] >= above) {
      s->lowest_bin = (uint16_t)k;
      s->stage = 3;
    }
  }
}
