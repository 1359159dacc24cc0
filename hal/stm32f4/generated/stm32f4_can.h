/// Registers of the STM32F4's CAN. Made by tools/gen/stm32f4_registers.py
/// from hal/stm32f4/registers.toml.
#ifndef STM32F4_CAN_H
#define STM32F4_CAN_H

#define CAN1_BASE 0x40006400u

#define CAN_MCR 0x000u
#define CAN_MCR_INRQ (0x1u << 0)
#define CAN_MCR_SLEEP (0x1u << 1)
#define CAN_MCR_TXFP (0x1u << 2)
#define CAN_MCR_RFLM (0x1u << 3)
#define CAN_MCR_NART (0x1u << 4)
#define CAN_MCR_AWUM (0x1u << 5)
#define CAN_MCR_ABOM (0x1u << 6)
#define CAN_MCR_TTCM (0x1u << 7)
#define CAN_MCR_RESET (0x1u << 15)
#define CAN_MCR_DBF (0x1u << 16)

#define CAN_MSR 0x004u
#define CAN_MSR_INAK (0x1u << 0)
#define CAN_MSR_SLAK (0x1u << 1)
#define CAN_MSR_ERRI (0x1u << 2)
#define CAN_MSR_WKUI (0x1u << 3)
#define CAN_MSR_SLAKI (0x1u << 4)
#define CAN_MSR_TXM (0x1u << 8)
#define CAN_MSR_RXM (0x1u << 9)
#define CAN_MSR_SAMP (0x1u << 10)
#define CAN_MSR_RX (0x1u << 11)

#define CAN_TSR 0x008u
#define CAN_TSR_RQCP0 (0x1u << 0)
#define CAN_TSR_TXOK0 (0x1u << 1)
#define CAN_TSR_ALST0 (0x1u << 2)
#define CAN_TSR_TERR0 (0x1u << 3)
#define CAN_TSR_ABRQ0 (0x1u << 7)
#define CAN_TSR_RQCP1 (0x1u << 8)
#define CAN_TSR_TXOK1 (0x1u << 9)
#define CAN_TSR_ALST1 (0x1u << 10)
#define CAN_TSR_TERR1 (0x1u << 11)
#define CAN_TSR_ABRQ1 (0x1u << 15)
#define CAN_TSR_RQCP2 (0x1u << 16)
#define CAN_TSR_TXOK2 (0x1u << 17)
#define CAN_TSR_ALST2 (0x1u << 18)
#define CAN_TSR_TERR2 (0x1u << 19)
#define CAN_TSR_ABRQ2 (0x1u << 23)
#define CAN_TSR_CODE (0x3u << 24)
#define CAN_TSR_CODE_AT 24u
#define CAN_TSR_TME0 (0x1u << 26)
#define CAN_TSR_TME1 (0x1u << 27)
#define CAN_TSR_TME2 (0x1u << 28)
#define CAN_TSR_LOW0 (0x1u << 29)
#define CAN_TSR_LOW1 (0x1u << 30)
#define CAN_TSR_LOW2 (0x1u << 31)

#define CAN_RF0R 0x00cu
#define CAN_RF0R_FMP (0x3u << 0)
#define CAN_RF0R_FMP_AT 0u
#define CAN_RF0R_FULL (0x1u << 3)
#define CAN_RF0R_FOVR (0x1u << 4)
#define CAN_RF0R_RFOM (0x1u << 5)

#define CAN_IER 0x014u
#define CAN_IER_TMEIE (0x1u << 0)
#define CAN_IER_FMPIE0 (0x1u << 1)
#define CAN_IER_FFIE0 (0x1u << 2)
#define CAN_IER_FOVIE0 (0x1u << 3)
#define CAN_IER_FMPIE1 (0x1u << 4)
#define CAN_IER_FFIE1 (0x1u << 5)
#define CAN_IER_FOVIE1 (0x1u << 6)
#define CAN_IER_EWGIE (0x1u << 8)
#define CAN_IER_EPVIE (0x1u << 9)
#define CAN_IER_BOFIE (0x1u << 10)
#define CAN_IER_LECIE (0x1u << 11)
#define CAN_IER_ERRIE (0x1u << 15)
#define CAN_IER_WKUIE (0x1u << 16)
#define CAN_IER_SLKIE (0x1u << 17)

#define CAN_ESR 0x018u
#define CAN_ESR_EWGF (0x1u << 0)
#define CAN_ESR_EPVF (0x1u << 1)
#define CAN_ESR_BOFF (0x1u << 2)
#define CAN_ESR_LEC (0x7u << 4)
#define CAN_ESR_LEC_AT 4u
#define CAN_ESR_TEC (0xffu << 16)
#define CAN_ESR_TEC_AT 16u
#define CAN_ESR_REC (0xffu << 24)
#define CAN_ESR_REC_AT 24u

#define CAN_BTR 0x01cu
#define CAN_BTR_BRP (0x3ffu << 0)
#define CAN_BTR_BRP_AT 0u
#define CAN_BTR_TS1 (0xfu << 16)
#define CAN_BTR_TS1_AT 16u
#define CAN_BTR_TS2 (0x7u << 20)
#define CAN_BTR_TS2_AT 20u
#define CAN_BTR_SJW (0x3u << 24)
#define CAN_BTR_SJW_AT 24u
#define CAN_BTR_LBKM (0x1u << 30)
#define CAN_BTR_SILM (0x1u << 31)

#define CAN_FMR 0x200u
#define CAN_FMR_FINIT (0x1u << 0)
#define CAN_FMR_CAN2SB (0x3fu << 8)
#define CAN_FMR_CAN2SB_AT 8u

#define CAN_FM1R 0x204u
#define CAN_FM1R_FBM0 (0x1u << 0)
#define CAN_FM1R_FBM1 (0x1u << 1)
#define CAN_FM1R_FBM2 (0x1u << 2)
#define CAN_FM1R_FBM3 (0x1u << 3)
#define CAN_FM1R_FBM4 (0x1u << 4)
#define CAN_FM1R_FBM5 (0x1u << 5)
#define CAN_FM1R_FBM6 (0x1u << 6)
#define CAN_FM1R_FBM7 (0x1u << 7)
#define CAN_FM1R_FBM8 (0x1u << 8)
#define CAN_FM1R_FBM9 (0x1u << 9)
#define CAN_FM1R_FBM10 (0x1u << 10)
#define CAN_FM1R_FBM11 (0x1u << 11)
#define CAN_FM1R_FBM12 (0x1u << 12)
#define CAN_FM1R_FBM13 (0x1u << 13)
#define CAN_FM1R_FBM14 (0x1u << 14)
#define CAN_FM1R_FBM15 (0x1u << 15)
#define CAN_FM1R_FBM16 (0x1u << 16)
#define CAN_FM1R_FBM17 (0x1u << 17)
#define CAN_FM1R_FBM18 (0x1u << 18)
#define CAN_FM1R_FBM19 (0x1u << 19)
#define CAN_FM1R_FBM20 (0x1u << 20)
#define CAN_FM1R_FBM21 (0x1u << 21)
#define CAN_FM1R_FBM22 (0x1u << 22)
#define CAN_FM1R_FBM23 (0x1u << 23)
#define CAN_FM1R_FBM24 (0x1u << 24)
#define CAN_FM1R_FBM25 (0x1u << 25)
#define CAN_FM1R_FBM26 (0x1u << 26)
#define CAN_FM1R_FBM27 (0x1u << 27)

#define CAN_FS1R 0x20cu
#define CAN_FS1R_FSC0 (0x1u << 0)
#define CAN_FS1R_FSC1 (0x1u << 1)
#define CAN_FS1R_FSC2 (0x1u << 2)
#define CAN_FS1R_FSC3 (0x1u << 3)
#define CAN_FS1R_FSC4 (0x1u << 4)
#define CAN_FS1R_FSC5 (0x1u << 5)
#define CAN_FS1R_FSC6 (0x1u << 6)
#define CAN_FS1R_FSC7 (0x1u << 7)
#define CAN_FS1R_FSC8 (0x1u << 8)
#define CAN_FS1R_FSC9 (0x1u << 9)
#define CAN_FS1R_FSC10 (0x1u << 10)
#define CAN_FS1R_FSC11 (0x1u << 11)
#define CAN_FS1R_FSC12 (0x1u << 12)
#define CAN_FS1R_FSC13 (0x1u << 13)
#define CAN_FS1R_FSC14 (0x1u << 14)
#define CAN_FS1R_FSC15 (0x1u << 15)
#define CAN_FS1R_FSC16 (0x1u << 16)
#define CAN_FS1R_FSC17 (0x1u << 17)
#define CAN_FS1R_FSC18 (0x1u << 18)
#define CAN_FS1R_FSC19 (0x1u << 19)
#define CAN_FS1R_FSC20 (0x1u << 20)
#define CAN_FS1R_FSC21 (0x1u << 21)
#define CAN_FS1R_FSC22 (0x1u << 22)
#define CAN_FS1R_FSC23 (0x1u << 23)
#define CAN_FS1R_FSC24 (0x1u << 24)
#define CAN_FS1R_FSC25 (0x1u << 25)
#define CAN_FS1R_FSC26 (0x1u << 26)
#define CAN_FS1R_FSC27 (0x1u << 27)

#define CAN_FFA1R 0x214u
#define CAN_FFA1R_FFA0 (0x1u << 0)
#define CAN_FFA1R_FFA1 (0x1u << 1)
#define CAN_FFA1R_FFA2 (0x1u << 2)
#define CAN_FFA1R_FFA3 (0x1u << 3)
#define CAN_FFA1R_FFA4 (0x1u << 4)
#define CAN_FFA1R_FFA5 (0x1u << 5)
#define CAN_FFA1R_FFA6 (0x1u << 6)
#define CAN_FFA1R_FFA7 (0x1u << 7)
#define CAN_FFA1R_FFA8 (0x1u << 8)
#define CAN_FFA1R_FFA9 (0x1u << 9)
#define CAN_FFA1R_FFA10 (0x1u << 10)
#define CAN_FFA1R_FFA11 (0x1u << 11)
#define CAN_FFA1R_FFA12 (0x1u << 12)
#define CAN_FFA1R_FFA13 (0x1u << 13)
#define CAN_FFA1R_FFA14 (0x1u << 14)
#define CAN_FFA1R_FFA15 (0x1u << 15)
#define CAN_FFA1R_FFA16 (0x1u << 16)
#define CAN_FFA1R_FFA17 (0x1u << 17)
#define CAN_FFA1R_FFA18 (0x1u << 18)
#define CAN_FFA1R_FFA19 (0x1u << 19)
#define CAN_FFA1R_FFA20 (0x1u << 20)
#define CAN_FFA1R_FFA21 (0x1u << 21)
#define CAN_FFA1R_FFA22 (0x1u << 22)
#define CAN_FFA1R_FFA23 (0x1u << 23)
#define CAN_FFA1R_FFA24 (0x1u << 24)
#define CAN_FFA1R_FFA25 (0x1u << 25)
#define CAN_FFA1R_FFA26 (0x1u << 26)
#define CAN_FFA1R_FFA27 (0x1u << 27)

#define CAN_FA1R 0x21cu
#define CAN_FA1R_FACT0 (0x1u << 0)
#define CAN_FA1R_FACT1 (0x1u << 1)
#define CAN_FA1R_FACT2 (0x1u << 2)
#define CAN_FA1R_FACT3 (0x1u << 3)
#define CAN_FA1R_FACT4 (0x1u << 4)
#define CAN_FA1R_FACT5 (0x1u << 5)
#define CAN_FA1R_FACT6 (0x1u << 6)
#define CAN_FA1R_FACT7 (0x1u << 7)
#define CAN_FA1R_FACT8 (0x1u << 8)
#define CAN_FA1R_FACT9 (0x1u << 9)
#define CAN_FA1R_FACT10 (0x1u << 10)
#define CAN_FA1R_FACT11 (0x1u << 11)
#define CAN_FA1R_FACT12 (0x1u << 12)
#define CAN_FA1R_FACT13 (0x1u << 13)
#define CAN_FA1R_FACT14 (0x1u << 14)
#define CAN_FA1R_FACT15 (0x1u << 15)
#define CAN_FA1R_FACT16 (0x1u << 16)
#define CAN_FA1R_FACT17 (0x1u << 17)
#define CAN_FA1R_FACT18 (0x1u << 18)
#define CAN_FA1R_FACT19 (0x1u << 19)
#define CAN_FA1R_FACT20 (0x1u << 20)
#define CAN_FA1R_FACT21 (0x1u << 21)
#define CAN_FA1R_FACT22 (0x1u << 22)
#define CAN_FA1R_FACT23 (0x1u << 23)
#define CAN_FA1R_FACT24 (0x1u << 24)
#define CAN_FA1R_FACT25 (0x1u << 25)
#define CAN_FA1R_FACT26 (0x1u << 26)
#define CAN_FA1R_FACT27 (0x1u << 27)

#define CAN_TX_TIR(n) (0x180u + 16u * (n)) // n: 0 .. 2
#define CAN_TX_TIR_TXRQ (0x1u << 0)
#define CAN_TX_TIR_RTR (0x1u << 1)
#define CAN_TX_TIR_IDE (0x1u << 2)
#define CAN_TX_TIR_EXID (0x3ffffu << 3)
#define CAN_TX_TIR_EXID_AT 3u
#define CAN_TX_TIR_STID (0x7ffu << 21)
#define CAN_TX_TIR_STID_AT 21u

#define CAN_TX_TDTR(n) (0x184u + 16u * (n)) // n: 0 .. 2
#define CAN_TX_TDTR_DLC (0xfu << 0)
#define CAN_TX_TDTR_DLC_AT 0u
#define CAN_TX_TDTR_TGT (0x1u << 8)
#define CAN_TX_TDTR_TIME (0xffffu << 16)
#define CAN_TX_TDTR_TIME_AT 16u

#define CAN_TX_TDLR(n) (0x188u + 16u * (n)) // n: 0 .. 2
#define CAN_TX_TDLR_DATA0 (0xffu << 0)
#define CAN_TX_TDLR_DATA0_AT 0u
#define CAN_TX_TDLR_DATA1 (0xffu << 8)
#define CAN_TX_TDLR_DATA1_AT 8u
#define CAN_TX_TDLR_DATA2 (0xffu << 16)
#define CAN_TX_TDLR_DATA2_AT 16u
#define CAN_TX_TDLR_DATA3 (0xffu << 24)
#define CAN_TX_TDLR_DATA3_AT 24u

#define CAN_TX_TDHR(n) (0x18cu + 16u * (n)) // n: 0 .. 2
#define CAN_TX_TDHR_DATA4 (0xffu << 0)
#define CAN_TX_TDHR_DATA4_AT 0u
#define CAN_TX_TDHR_DATA5 (0xffu << 8)
#define CAN_TX_TDHR_DATA5_AT 8u
#define CAN_TX_TDHR_DATA6 (0xffu << 16)
#define CAN_TX_TDHR_DATA6_AT 16u
#define CAN_TX_TDHR_DATA7 (0xffu << 24)
#define CAN_TX_TDHR_DATA7_AT 24u

#define CAN_RX_RIR(n) (0x1b0u + 16u * (n)) // n: 0 .. 1
#define CAN_RX_RIR_RTR (0x1u << 1)
#define CAN_RX_RIR_IDE (0x1u << 2)
#define CAN_RX_RIR_EXID (0x3ffffu << 3)
#define CAN_RX_RIR_EXID_AT 3u
#define CAN_RX_RIR_STID (0x7ffu << 21)
#define CAN_RX_RIR_STID_AT 21u

#define CAN_RX_RDTR(n) (0x1b4u + 16u * (n)) // n: 0 .. 1
#define CAN_RX_RDTR_DLC (0xfu << 0)
#define CAN_RX_RDTR_DLC_AT 0u
#define CAN_RX_RDTR_FMI (0xffu << 8)
#define CAN_RX_RDTR_FMI_AT 8u
#define CAN_RX_RDTR_TIME (0xffffu << 16)
#define CAN_RX_RDTR_TIME_AT 16u

#define CAN_RX_RDLR(n) (0x1b8u + 16u * (n)) // n: 0 .. 1
#define CAN_RX_RDLR_DATA0 (0xffu << 0)
#define CAN_RX_RDLR_DATA0_AT 0u
#define CAN_RX_RDLR_DATA1 (0xffu << 8)
#define CAN_RX_RDLR_DATA1_AT 8u
#define CAN_RX_RDLR_DATA2 (0xffu << 16)
#define CAN_RX_RDLR_DATA2_AT 16u
#define CAN_RX_RDLR_DATA3 (0xffu << 24)
#define CAN_RX_RDLR_DATA3_AT 24u

#define CAN_RX_RDHR(n) (0x1bcu + 16u * (n)) // n: 0 .. 1
#define CAN_RX_RDHR_DATA4 (0xffu << 0)
#define CAN_RX_RDHR_DATA4_AT 0u
#define CAN_RX_RDHR_DATA5 (0xffu << 8)
#define CAN_RX_RDHR_DATA5_AT 8u
#define CAN_RX_RDHR_DATA6 (0xffu << 16)
#define CAN_RX_RDHR_DATA6_AT 16u
#define CAN_RX_RDHR_DATA7 (0xffu << 24)
#define CAN_RX_RDHR_DATA7_AT 24u

#define CAN_FB_FR1(n) (0x240u + 8u * (n)) // n: 0 .. 27
#define CAN_FB_FR1_FB (0xffffffffu << 0)
#define CAN_FB_FR1_FB_AT 0u

#define CAN_FB_FR2(n) (0x244u + 8u * (n)) // n: 0 .. 27
#define CAN_FB_FR2_FB (0xffffffffu << 0)
#define CAN_FB_FR2_FB_AT 0u

#endif
