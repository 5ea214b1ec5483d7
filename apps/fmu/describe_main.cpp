// Writes the FMU's model description for FMI 2 or 3 to standard output.
#include <cstdio>
#include <string_view>

#include "variables.hpp"

int main(int argc, char** argv) {
  const bool is_3 = argc > 1 && std::string_view(argv[1]) == "3";
  const std::string text =
      underbrush::fmu::description(is_3 ? underbrush::fmu::Fmi::k3 : underbrush::fmu::Fmi::k2);
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() ? 0 : 1;
}
