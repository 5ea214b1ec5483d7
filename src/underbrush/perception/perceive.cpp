#include "underbrush/perception/perceive.hpp"

#include <chrono>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {

PerceivedLog perceived(BeamSource& log, const LogTruth* truth, const PerceptionSetup& setup,
                       const std::function<void(const MergedCloud&)>& see) {
  using Clock = std::chrono::steady_clock;
  require(truth || !setup.is_model, "perceive: the tracking model needs the truth (--truth)");
  CycleReader reader(log, setup.rig, setup.cycles);
  TrackingModel model(setup.model);
  ObjectPipeline real(setup.real);
  FalsePositives ghosts(setup.ghosts, setup.seed);
  PerceivedLog out;
  MergedCloud cloud;
  TruthFrame frame;
  while (reader.next(cloud)) {
    if (see) see(cloud);
    if (truth) {
      truth->at(reader.scan(), cloud.time_s, reader.cycle_s(), frame);
      out.truth.push_back(list_of_truth(frame, cloud.world_from_vehicle));
    }
    ObjectList list;
    const auto start = Clock::now();
    if (setup.is_model) {
      model.step(cloud, frame, list);
    } else {
      real.step(cloud, list);
    }
    ghosts.step(list);
    out.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    out.points += cloud.size();
    out.lists.push_back(std::move(list));
  }
  return out;
}

}  // namespace underbrush::perception
