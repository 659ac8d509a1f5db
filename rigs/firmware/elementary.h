/* e^x without libm, so that every target gives the same bits. */
#ifndef FORCEGATE_FIRMWARE_ELEMENTARY_H
#define FORCEGATE_FIRMWARE_ELEMENTARY_H

/* x in [-80, 0]; relative error < 3e-7. Outside: clamped to the nearest end. */
float fw_exp_nonpositive(float x);

#endif
