/* Constants of algorithm "paredes-2-2-1/1": the frame in which the source alternates, and the circuit. */
#ifndef FORCEGATE_FIRMWARE_PARAMETERS_H
#define FORCEGATE_FIRMWARE_PARAMETERS_H

#define FW_ALGORITHM_ID "paredes-2-2-1/1"

/* One frame: first channel, samples under the direct voltage; second channel, samples under the sine, whose phase is 0 at
   its first sample. */
#define FW_RATE_HZ 40000
#define FW_DIRECT_SAMPLES 600 /* 15 ms */
#define FW_SINE_SAMPLES 200   /* 5 ms, 20 periods */
#define FW_SINE_PERIOD 10     /* samples: 4 kHz (Paredes-Madrid et al. 2010, eq. 10) */
#define FW_FRAME_SAMPLES (FW_DIRECT_SAMPLES + FW_SINE_SAMPLES)

#define FW_SINE_V 3.0f
#define FW_SINE_HZ 4000.0f
#define FW_FEEDBACK_OHM 120e3f
#define FW_AMPLIFIER_HZ 8e6f /* gain-bandwidth product: turns the phase by FW_SINE_HZ over it */

#define FW_FORCE_CLAMP_N 300.0f

#endif
