#pragma once
// Elementary functions whose bits do not depend on the C library or the processor. glibc chooses
// FMA variants at run time, so std::sin may differ in the last bit between two machines; traces
// that are compared byte for byte are made with these instead. Only + - * / and integer operations.

namespace forcegate::portable {

/// sin(x) and cos(x), |x| <= 1e6 rad, absolute error < 4e-16 near 0 and < 2e-15 up to 1e4 rad.
double sin(double x);
double cos(double x);

/// e^x, relative error < 4e-16 for -700 <= x <= 700; 0 below, +inf above 709.78.
double exp(double x);

/// Natural logarithm, x > 0 (NaN otherwise), relative error < 4e-16.
double log(double x);

/// x^y for x > 0 as exp(y log x); relative error < 1e-14 while |y log x| < 50.
double pow(double x, double y);

}  // namespace forcegate::portable
