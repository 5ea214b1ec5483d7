#if defined(__x86_64__)
#include "underbrush/fit/pass_kernel.inl"

namespace underbrush::fit {

const PassKernels kPassAvx512{approach, add};

}  // namespace underbrush::fit
#endif
