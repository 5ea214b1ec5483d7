// Runs a chain with a strategy of a shared library, whose path is the argument. It exits with 0 if
// the library's object is where the detections are.
#include "underbrush/osi/chain.hpp"

#include <cstdio>
#include <exception>

int main(int, char** words) {
  using namespace underbrush;
  try {
    osi::ChainFile file;
    file.strategies.push_back({"mean_tracker", words[1], {{"gain", "2"}}, "chain", "[0]"});
    osi::Chain chain(file);
    osi::SensorData data;
    data.timestamp = osi::Timestamp{1, 0};
    data.logical.emplace();
    for (const double x : {10.0, 12.0, 14.0}) {
      data.logical->detections.push_back({1, osi::kNoId, {x, 1, 0}, 50, 0, 0});
    }
    chain.step(data);
    osi::Chain copy = chain.clone();
    copy.step(data);
    const bool found = data.objects.size() == 1 && data.object_header->cycle_counter == 2 &&
                       (*data.objects[0].base.position_m - Vec3(12, 1, 0)).norm() < 1e-12;
    std::printf("a strategy of a library: %s\n", found ? "works" : "fails");
    if (!found) return 1;
    file.strategies[0].parameters = {{"fail", "please"}};
    osi::Chain refused(file);
  } catch (const std::exception& e) {
    std::printf("refused: %s\n", e.what());
    return 0;
  }
  return 1;
}
