#include "verbs.hpp"

int main(int argc, char** argv) {
  using namespace underbrush;
  app::Program program("underbrush", app::kSummary);
  app::add_all_verbs(program);
  return program.run(argc, argv);
}
