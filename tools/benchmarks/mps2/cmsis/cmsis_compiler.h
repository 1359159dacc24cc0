/* What CMSIS-DSP expects of CMSIS-Core's header of this name, for GCC and a core with the DSP
   extension: attributes, and the DSP instructions by their CMSIS names. Here they stand for the
   intrinsics of the compiler's own <arm_acle.h>, of which only the argument types differ. */
#ifndef CMSIS_COMPILER_H
#define CMSIS_COMPILER_H

#include <arm_acle.h>
#include <stdint.h>

#ifndef __ARM_FEATURE_DSP
#error "this header is for cores with the DSP extension"
#endif

#define __ALIGNED(bytes) __attribute__((aligned(bytes)))
#define __WEAK __attribute__((weak))
#define __STATIC_INLINE static inline
#define __STATIC_FORCEINLINE static inline __attribute__((always_inline))

/* One instruction, which gives 32 for 0. */
#define __CLZ(word) ((uint8_t)((word) == 0 ? 32 : __builtin_clz((uint32_t)(word))))
#define __SSAT(word, bits) __ssat((word), (bits))
#define __USAT(word, bits) ((uint32_t)__usat((word), (bits)))

/* CMSIS passes packed halfwords as unsigned words. */
#define DSP_OF_TWO(name, intrinsic)                                                                \
    __STATIC_FORCEINLINE uint32_t name(uint32_t x, uint32_t y) {                                   \
        return (uint32_t)intrinsic((int32_t)x, (int32_t)y);                                        \
    }
#define DSP_OF_THREE(name, intrinsic)                                                              \
    __STATIC_FORCEINLINE uint32_t name(uint32_t x, uint32_t y, uint32_t sum) {                     \
        return (uint32_t)intrinsic((int32_t)x, (int32_t)y, (int32_t)sum);                          \
    }
#define DSP_LONG(name, intrinsic)                                                                  \
    __STATIC_FORCEINLINE uint64_t name(uint32_t x, uint32_t y, uint64_t sum) {                     \
        return (uint64_t)intrinsic((int32_t)x, (int32_t)y, (int64_t)sum);                          \
    }

DSP_OF_TWO(__QADD, __qadd)
DSP_OF_TWO(__QSUB, __qsub)
DSP_OF_TWO(__QADD8, __qadd8)
DSP_OF_TWO(__QSUB8, __qsub8)
DSP_OF_TWO(__QADD16, __qadd16)
DSP_OF_TWO(__QSUB16, __qsub16)
DSP_OF_TWO(__SHADD16, __shadd16)
DSP_OF_TWO(__SHSUB16, __shsub16)
DSP_OF_TWO(__QASX, __qasx)
DSP_OF_TWO(__QSAX, __qsax)
DSP_OF_TWO(__SHASX, __shasx)
DSP_OF_TWO(__SHSAX, __shsax)
DSP_OF_TWO(__SMUAD, __smuad)
DSP_OF_TWO(__SMUADX, __smuadx)
DSP_OF_TWO(__SMUSD, __smusd)
DSP_OF_TWO(__SMUSDX, __smusdx)
DSP_OF_THREE(__SMLAD, __smlad)
DSP_OF_THREE(__SMLADX, __smladx)
DSP_OF_THREE(__SMLSDX, __smlsdx)
DSP_LONG(__SMLALD, __smlald)
DSP_LONG(__SMLALDX, __smlaldx)

__STATIC_FORCEINLINE uint32_t __PKHBT(uint32_t low, uint32_t high, uint32_t shift) {
    return (low & 0xFFFFu) | ((high << shift) & 0xFFFF0000u);
}

__STATIC_FORCEINLINE uint32_t __PKHTB(uint32_t high, uint32_t low, uint32_t shift) {
    return (high & 0xFFFF0000u) | ((uint32_t)((int32_t)low >> shift) & 0xFFFFu);
}

#endif
