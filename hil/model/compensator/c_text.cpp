#include "hil/model/compensator/c_text.h"

#include <fmt/format.h>

#include "hil/model/compensator/c_expression.h"

namespace forcegate::c_text {

std::string elementary(bool exponential, bool logarithm, bool root, bool tangent) {
  std::string out = R"(static inline float fg_min(float a, float b) { return a < b ? a : b; }
static inline float fg_max(float a, float b) { return a > b ? a : b; }
static inline float fg_clamp(float x, float low, float high) { return x < low ? low : (x > high ? high : x); }
static inline float fg_abs(float x) { return x < 0.0f ? -x : x; }
static inline float fg_sign(float x) { return x > 0.0f ? 1.0f : (x < 0.0f ? -1.0f : 0.0f); }
)";
  if (exponential || tangent)
    out += R"(
/* e^x for x in [-80, 80], clamped outside. */
static inline float fg_exp(float x) {
  x = fg_clamp(x, -80.0f, 80.0f);
  const int32_t k = (int32_t)(x * 1.44269504f + (x < 0.0f ? -0.5f : 0.5f));
  const float kf = (float)k;
  const float r = (x - kf * 0.693359375f) + kf * 2.12194440e-4f;
  float p = 1.0f / 5040.0f;
  p = p * r + 1.0f / 720.0f;
  p = p * r + 1.0f / 120.0f;
  p = p * r + 1.0f / 24.0f;
  p = p * r + 1.0f / 6.0f;
  p = p * r + 0.5f;
  const float mantissa = 1.0f + (r + r * r * p);
  const uint32_t bits = (uint32_t)(k + 127) << 23;
  float scale;
  memcpy(&scale, &bits, sizeof scale);
  return mantissa * scale;
}
)";
  if (logarithm)
    out += R"(
/* ln x for x > 0, the logarithm of the least normal number below. */
static inline float fg_ln(float x) {
  if (!(x > 1.17549435e-38f)) return -87.3365448f;
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  int32_t k = (int32_t)(bits >> 23) - 127;
  bits = (bits & 0x007fffffu) | 0x3f800000u;
  float m;
  memcpy(&m, &bits, sizeof m);
  if (m > 1.41421356f) {
    m = 0.5f * m;
    ++k;
  }
  const float s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
  float p = 2.0f / 11.0f;
  p = p * s2 + 2.0f / 9.0f;
  p = p * s2 + 2.0f / 7.0f;
  p = p * s2 + 2.0f / 5.0f;
  p = p * s2 + 2.0f / 3.0f;
  return (float)k * 0.693359375f + (s * (2.0f + s2 * p) - (float)k * 2.12194440e-4f);
}
)";
  if (root)
    out += R"(
/* Square root, 0 for x <= 0. */
static inline float fg_sqrt(float x) {
  if (!(x > 1.17549435e-38f)) return 0.0f;
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  bits = 0x1fbd1df5u + (bits >> 1);
  float y;
  memcpy(&y, &bits, sizeof y);
  for (int i = 0; i < 3; ++i) y = 0.5f * (y + x / y);
  return y;
}
)";
  if (tangent)
    out += R"(
static inline float fg_tanh(float x) {
  const float a = fg_abs(x);
  if (a < 0.03f) return x * (1.0f - a * a * (1.0f / 3.0f));
  const float e = fg_exp(-(2.0f * a)), y = (1.0f - e) / (1.0f + e);
  return x < 0.0f ? -y : y;
}
)";
  return out + "\n";
}

std::string powers(bool real, bool whole) {
  std::string out;
  if (real)
    out += R"(
/* x^y, 0 for x <= 0. */
static inline float fg_pow(float x, float y) { return x > 1.17549435e-38f ? fg_exp(y * fg_ln(x)) : (y == 0.0f ? 1.0f : 0.0f); }
)";
  if (whole)
    out += R"(
/* x^n, n > 0, by squaring. */
static inline float fg_power(float x, int n) {
  float out = 1.0f;
  for (; n > 0; n >>= 1) {
    if (n & 1) out = out * x;
    x = x * x;
  }
  return out;
}
)";
  return out;
}

std::string residual() {
  return R"(static inline float fg_comp_residual(const FgComp* c, float F) {
  return ((c->low_N + c->shrink * (F - c->low_N)) + fg_comp_added(c, F)) - c->u_N;
}

)";
}

std::string step(const std::string& prepare, const std::string& commit, const std::string& start, double reach, double step_s,
                 int iterations) {
  return fmt::format(
      R"(/* What may be computed with: no NaN, and nothing whose powers leave the range of a float. */
static inline int fg_comp_is_number(float x) {{ return x > -1e9f && x < 1e9f; }}

/* One sample -> force in newtons. u_N = G U + F0. shrink: D, 1 without cyclic loading. floor_N: lowest settled u_N of the
   cycling, any number while D is 1. temperature_C: read only where FG_COMP_NEEDS_TEMPERATURE is 1.
   A sample with an input that is no number (NaN, infinite), or with a shrink that is not above 0, is left out: the state stays as
   it was but for the time, and the force of the sample before comes back (0 before the first). */
static inline float fg_comp_step(FgComp* c, float u_N, float shrink, float floor_N, float temperature_C) {{
  if (!fg_comp_is_number(u_N) || !fg_comp_is_number(shrink) || !(shrink > 0.0f) || !fg_comp_is_number(floor_N) ||
      (FG_COMP_NEEDS_TEMPERATURE && !fg_comp_is_number(temperature_C))) {{
    c->t_s = (float)++c->samples * {5};
    return c->force_N;
  }}
  c->u_N = u_N;
  c->shrink = shrink;
  c->low_N = floor_N - c->at_floor_N;
  c->temperature_C = temperature_C;
{0}
  /* the right side rises by at least shrink / {1} a newton: the root lies between a and b */
  float a = c->running ? {6} : u_N;
  float at_a = fg_comp_residual(c, a);
  float b = a - at_a * ({2} / shrink);
  float at_b = fg_comp_residual(c, b);
  for (int i = 0; i < {3} && at_b != 0.0f && at_b != at_a; ++i) {{
    const float x = b - at_b * ((b - a) / (at_b - at_a));
    const float at_x = fg_comp_residual(c, x);
    if ((at_x > 0.0f) != (at_b > 0.0f)) {{
      a = b;
      at_a = at_b;
    }} else {{
      at_a *= 0.5f;
    }}
    b = x;
    at_b = at_x;
  }}
  const float F = b;
  const float W = c->low_N + c->shrink * (F - c->low_N);
  const float e = u_N - W;
{4}
  /* what the effects added where the force was least: the floor that the firmware sees carries it */
  if (!c->running) c->turn_u_N = u_N;
  if (c->falling) {{
    if (u_N < c->turn_u_N) {{
      c->turn_u_N = u_N;
      c->turn_e_N = e;
    }} else if (u_N > c->turn_u_N + 0.05f) {{
      c->at_floor_N = c->turn_e_N;
      c->falling = 0;
      c->turn_u_N = u_N;
    }}
  }} else if (u_N > c->turn_u_N) {{
    c->turn_u_N = u_N;
  }} else if (u_N < c->turn_u_N - 0.05f) {{
    c->falling = 1;
    c->turn_u_N = u_N;
    c->turn_e_N = e;
  }}
  c->running = 1;
  c->t_s = (float)++c->samples * {5};
  (void)W;
  return c->force_N = F;
}}

)",
      prepare, fmt::format("{:.3g}", reach), c_float(reach), iterations, commit, c_float(step_s), start);
}

}  // namespace forcegate::c_text
