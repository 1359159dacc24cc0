/// Registers of the STM32F4's USART. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_USART_H
#define STM32F4_USART_H

#define USART1_BASE 0x40011000u
#define USART2_BASE 0x40004400u
#define USART3_BASE 0x40004800u

#define USART_SR 0x000u
#define USART_SR_PE (0x1u << 0)
#define USART_SR_FE (0x1u << 1)
#define USART_SR_NF (0x1u << 2)
#define USART_SR_ORE (0x1u << 3)
#define USART_SR_IDLE (0x1u << 4)
#define USART_SR_RXNE (0x1u << 5)
#define USART_SR_TC (0x1u << 6)
#define USART_SR_TXE (0x1u << 7)
#define USART_SR_LBD (0x1u << 8)
#define USART_SR_CTS (0x1u << 9)

#define USART_DR 0x004u
#define USART_DR_DR (0x1ffu << 0)
#define USART_DR_DR_AT 0u

#define USART_BRR 0x008u
#define USART_BRR_DIV_FRACTION (0xfu << 0)
#define USART_BRR_DIV_FRACTION_AT 0u
#define USART_BRR_DIV_MANTISSA (0xfffu << 4)
#define USART_BRR_DIV_MANTISSA_AT 4u

#define USART_CR1 0x00cu
#define USART_CR1_SBK (0x1u << 0)
#define USART_CR1_RWU (0x1u << 1)
#define USART_CR1_RE (0x1u << 2)
#define USART_CR1_TE (0x1u << 3)
#define USART_CR1_IDLEIE (0x1u << 4)
#define USART_CR1_RXNEIE (0x1u << 5)
#define USART_CR1_TCIE (0x1u << 6)
#define USART_CR1_TXEIE (0x1u << 7)
#define USART_CR1_PEIE (0x1u << 8)
#define USART_CR1_PS (0x1u << 9)
#define USART_CR1_PCE (0x1u << 10)
#define USART_CR1_WAKE (0x1u << 11)
#define USART_CR1_M (0x1u << 12)
#define USART_CR1_UE (0x1u << 13)
#define USART_CR1_OVER8 (0x1u << 15)

#define USART_CR2 0x010u
#define USART_CR2_ADD (0xfu << 0)
#define USART_CR2_ADD_AT 0u
#define USART_CR2_LBDL (0x1u << 5)
#define USART_CR2_LBDIE (0x1u << 6)
#define USART_CR2_LBCL (0x1u << 8)
#define USART_CR2_CPHA (0x1u << 9)
#define USART_CR2_CPOL (0x1u << 10)
#define USART_CR2_CLKEN (0x1u << 11)
#define USART_CR2_STOP (0x3u << 12)
#define USART_CR2_STOP_AT 12u
#define USART_CR2_LINEN (0x1u << 14)

#define USART_CR3 0x014u
#define USART_CR3_EIE (0x1u << 0)
#define USART_CR3_IREN (0x1u << 1)
#define USART_CR3_IRLP (0x1u << 2)
#define USART_CR3_HDSEL (0x1u << 3)
#define USART_CR3_NACK (0x1u << 4)
#define USART_CR3_SCEN (0x1u << 5)
#define USART_CR3_DMAR (0x1u << 6)
#define USART_CR3_DMAT (0x1u << 7)
#define USART_CR3_RTSE (0x1u << 8)
#define USART_CR3_CTSE (0x1u << 9)
#define USART_CR3_CTSIE (0x1u << 10)
#define USART_CR3_ONEBIT (0x1u << 11)

#endif
