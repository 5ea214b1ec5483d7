// Writes the FMU's model description to standard output.
#include <cstdio>

#include "variables.hpp"

int main() {
  const std::string text = underbrush::fmu::description();
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() ? 0 : 1;
}
