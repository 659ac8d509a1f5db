#include "ports/tick.h"

#define SYST_CSR (*(volatile uint32_t*)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t*)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t*)0xE000E018u)
#define PERIOD (TICK_CLOCK_HZ / TICK_RATE_HZ)

static volatile uint32_t ticks;
static uint32_t awake_at, late;

void systick_handler(void) { ticks = ticks + 1u; }

void tick_start(void) {
  SYST_RVR = PERIOD - 1u;
  SYST_CVR = 0;
  SYST_CSR = 7; /* processor clock, interrupt, on */
}

uint32_t tick_wait(void) {
  __asm__ volatile("cpsid i" ::: "memory");
  while (ticks == awake_at) __asm__ volatile("wfi\n\tcpsie i\n\tisb\n\tcpsid i" ::: "memory");
  awake_at = ticks;
  __asm__ volatile("cpsie i" ::: "memory");
  return SYST_CVR;
}

uint32_t tick_since(uint32_t reading) {
  const uint32_t now = SYST_CVR; /* counts down */
  const uint32_t missed = ticks - awake_at;
  if (missed > 0) ++late;
  return reading + missed * PERIOD - now;
}

uint32_t tick_late(void) { return late; }
