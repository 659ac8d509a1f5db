/* Reset: copy .data, clear .bss, switch the FPU on where there is one, run main. Faults end in port_exit, so
   that the host sees a dead image and not a silent one. */
#include <stdint.h>

extern uint32_t __data_load[], __data_start[], __data_end[], __bss_start[], __bss_end[], __stack_top[];
int main(void);
void port_exit(int status);

void reset_handler(void) __attribute__((noreturn));
static void fault_handler(void) {
  port_exit(99);
  for (;;) {
  }
}

__attribute__((section(".vectors"), used)) static const struct {
  uint32_t* stack;
  void (*handler[15])(void);
} kVectors = {__stack_top,
              {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, 0, 0,
               0, 0, fault_handler, fault_handler, 0, fault_handler, fault_handler}};

void reset_handler(void) {
#ifdef __ARM_FP
  *(volatile uint32_t*)0xE000ED88u |= 0xFu << 20; /* CPACR: full access to CP10 and CP11 */
  __asm__ volatile("dsb\n\tisb");
#endif
  if (&__data_load[0] != &__data_start[0])
    for (uint32_t i = 0; &__data_start[i] < __data_end; ++i)
      ((volatile uint32_t*)__data_start)[i] = __data_load[i];
  for (volatile uint32_t* p = __bss_start; p < __bss_end; ++p) *p = 0;
  port_exit(main());
  for (;;) {
  }
}
