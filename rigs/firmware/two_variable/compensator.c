#include "compensator.h"

#include <string.h>

#include "elementary.h"
#include "networks.h"

static const float kTwoPi = 6.28318530717958647692f;
static const float kSin[FW_SINE_PERIOD] = {0.0f, 0.58778525f, 0.95105652f, 0.95105652f, 0.58778525f, 0.0f, -0.58778525f, -0.95105652f, -0.95105652f, -0.58778525f};
static const float kCos[FW_SINE_PERIOD] = {1.0f, 0.80901699f, 0.30901699f, -0.30901699f, -0.80901699f, -1.0f, -0.80901699f, -0.30901699f, 0.30901699f, 0.80901699f};

static float hyperbolic_tangent(float x) {
  const float size = x < 0.0f ? -x : x;
  const float e = fw_exp_nonpositive(-2.0f * size);
  const float t = (1.0f - e) / (1.0f + e);
  return x < 0.0f ? -t : t;
}

int fw_sensor_of(const char* id) {
  const size_t n = sizeof FW_PACK_ID - 1;
  if (memcmp(id, FW_PACK_ID "/", n + 1) != 0) return -1;
  const int digit = id[n + 1] - '1';
  const int ends = n + 2 == FW_CALIBRATION_ID_SIZE || id[n + 2] == 0;
  return ends && digit >= 0 && digit < FW_PACK_SENSORS ? digit : -1;
}

void fw_compensator_reset(FwCompensator* c, const FwCalibration* calibration) {
  memset(c, 0, sizeof *c);
  c->calibration = *calibration;
  const int sensor = fw_sensor_of(calibration->id);
  c->network = &kNetworks[sensor < 0 ? 0 : sensor]; /* the link starts with a nominal calibration that names none */
  c->flags = FW_FLAG_LEARNING;
}

/* Eq. (6) with the amplifier's phase taken out: H = V_o/V_s, R_g Y = -H (1 + j d) / (1 + j d H). */
static float capacitance_pF(float in_phase, float quadrature) {
  const float d = FW_SINE_HZ / FW_AMPLIFIER_HZ;
  const float up_re = -(in_phase - d * quadrature), up_im = -(quadrature + d * in_phase);
  const float low_re = 1.0f - d * quadrature, low_im = d * in_phase;
  const float susceptance = (up_im * low_re - up_re * low_im) / (low_re * low_re + low_im * low_im);
  return 1e12f * susceptance / (FW_FEEDBACK_OHM * kTwoPi * FW_SINE_HZ);
}

static float network_force_N(const FwNetwork* net, float output_V, float pF) {
  const float v = (output_V - net->mean_V) / net->scale_V, p = (pF - net->mean_pF) / net->scale_pF;
  const float h1 = hyperbolic_tangent(net->w[0] + net->w[1] * v + net->w[2] * p);
  const float h2 = hyperbolic_tangent(net->w[3] + net->w[4] * v + net->w[5] * p);
  return net->mean_N + net->scale_N * (net->w[6] + net->w[7] * h1 + net->w[8] * h2);
}

static void finish_frame(FwCompensator* c) {
  const float lsb_V = c->calibration.v_range_V / (float)(1 << c->calibration.adc_bits);
  const float output_V = (float)c->direct * lsb_V / (float)FW_DIRECT_SAMPLES;
  float in_phase = 0.0f, quadrature = 0.0f;
  for (int k = 0; k < FW_SINE_PERIOD; ++k) {
    in_phase += (float)c->sine[k] * kSin[k];
    quadrature += (float)c->sine[k] * kCos[k];
  }
  const float scale = 2.0f * lsb_V / (float)FW_SINE_SAMPLES / FW_SINE_V;
  c->flags = 0;
  if (c->rail) {
    c->flags = FW_FLAG_INPUT_RAIL | FW_FLAG_LEARNING;
  } else {
    const float pF = capacitance_pF(in_phase * scale, quadrature * scale);
    float force_N = 2.0f * c->calibration.gain_N_per_V * network_force_N(c->network, output_V, pF) + c->calibration.offset_N;
    if (!(force_N >= -FW_FORCE_CLAMP_N && force_N <= FW_FORCE_CLAMP_N)) {
      force_N = force_N < 0.0f ? -FW_FORCE_CLAMP_N : FW_FORCE_CLAMP_N;
      c->flags = FW_FLAG_OUTPUT_CLAMPED;
    }
    c->force_N = force_N;
  }
  c->direct = 0;
  memset(c->sine, 0, sizeof c->sine);
  c->rail = 0;
  c->position = 0;
}

float fw_compensator_step(FwCompensator* c, uint16_t code, uint8_t* flags) {
  const int32_t middle = 1 << (c->calibration.adc_bits - 1);
  const int32_t value = (int32_t)code - middle;
  c->rail |= code == 0 || code >= 2 * middle - 1;
  if (c->position < FW_DIRECT_SAMPLES)
    c->direct += value;
  else
    c->sine[(c->position - FW_DIRECT_SAMPLES) % FW_SINE_PERIOD] += value;
  ++c->index;
  if (++c->position == FW_FRAME_SAMPLES) finish_frame(c);
  *flags = c->flags;
  return c->force_N;
}
