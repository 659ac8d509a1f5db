/* Reset: copy .data, clear .bss, switch the FPU on where there is one, run main. Faults end in port_exit, so
   that the host sees a dead image and not a silent one. */
#include <stdint.h>

#include "ports/stack.h"

extern uint32_t __data_load[], __data_start[], __data_end[], __bss_start[], __bss_end[], __stack_top[];
int main(void);
void port_exit(int status);

void reset_handler(void) __attribute__((noreturn));
static void fault_handler(void) {
  port_exit(99);
  for (;;) {
  }
}

void systick_handler(void) __attribute__((weak, alias("fault_handler")));

static uint32_t* painted_bottom(void) { return __stack_top - STACK_PAINTED_BYTES / 4u; }

uint32_t stack_used_bytes(void) {
  const uint32_t* p = painted_bottom();
  while (p < __stack_top && *(volatile const uint32_t*)p == STACK_PAINT) ++p;
  return 4u * (uint32_t)(__stack_top - p);
}

__attribute__((section(".vectors"), used)) static const struct {
  uint32_t* stack;
  void (*handler[15])(void);
} kVectors = {__stack_top,
              {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, 0, 0,
               0, 0, fault_handler, fault_handler, 0, fault_handler, systick_handler}};

void reset_handler(void) {
#ifdef __ARM_FP
  *(volatile uint32_t*)0xE000ED88u |= 0xFu << 20; /* CPACR: full access to CP10 and CP11 */
  __asm__ volatile("dsb\n\tisb");
#endif
  if (&__data_load[0] != &__data_start[0])
    for (uint32_t i = 0; &__data_start[i] < __data_end; ++i)
      ((volatile uint32_t*)__data_start)[i] = __data_load[i];
  for (volatile uint32_t* p = __bss_start; p < __bss_end; ++p) *p = 0;
  uint32_t* stack;
  __asm__ volatile("mov %0, sp" : "=r"(stack));
  for (volatile uint32_t* p = painted_bottom(); p < stack; ++p) *p = STACK_PAINT;
  port_exit(main());
  for (;;) {
  }
}
