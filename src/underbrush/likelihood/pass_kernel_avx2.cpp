#if defined(__x86_64__)
#include "underbrush/likelihood/pass_kernel.inl"

namespace underbrush::likelihood {

const PassKernels kPassAvx2{approach, add};

}  // namespace underbrush::likelihood
#endif
