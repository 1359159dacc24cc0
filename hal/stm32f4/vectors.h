/// What an image of this folder defines: its interrupts.
#ifndef VECTORS_H
#define VECTORS_H

void interrupt_console(void); ///< USART1, 2, 3: the board's
void interrupt_current(void); ///< ADC: current and supply have been measured

#endif
