#include "underbrush/perception/truth.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "underbrush/core/check.hpp"
#include "underbrush/perception/log_truth.hpp"

namespace underbrush::perception {
namespace {

TruthObject at(uint64_t id, double x, double yaw) {
  return {id, ObjectClass::kVan, {{x, 1, 2}, yaw, {4, 2, 2}}};
}

TEST(TruthSequence, InterpolatesObjectsAndTurnsTheShortWay) {
  const TruthSequence truth(std::vector<TruthFrame>{{1, {at(1, 20, -3.1)}}, {0, {at(1, 10, 3.1)}}});
  TruthFrame frame;
  truth.at(0.25, 0.1, frame);
  ASSERT_EQ(frame.objects.size(), 1u);
  EXPECT_NEAR(frame.objects[0].box.centre_m.x(), 12.5, 1e-12);
  EXPECT_NEAR(frame.objects[0].box.yaw_rad, 3.1 + 0.25 * (2 * M_PI - 6.2), 1e-12);
}

TEST(TruthSequence, AnObjectOfOneFrameIsThereAsLongAsTheToleranceSays) {
  const TruthSequence truth(std::vector<TruthFrame>{{0, {at(1, 1, 0)}}, {1, {at(2, 2, 0)}}});
  TruthFrame frame;
  truth.at(0.05, 0.1, frame);
  ASSERT_EQ(frame.objects.size(), 1u);
  EXPECT_EQ(frame.objects[0].id, 1u);
  truth.at(0.5, 0.1, frame);
  EXPECT_TRUE(frame.objects.empty());
  truth.at(1.05, 0.1, frame);
  ASSERT_EQ(frame.objects.size(), 1u);
  EXPECT_EQ(frame.objects[0].id, 2u);
  EXPECT_THROW(TruthSequence(std::vector<TruthFrame>{{0, {}}, {0, {}}}), std::invalid_argument);
}

TEST(LabelledBoxes, AreReadWithTheirFrames) {
  const auto path =
      std::filesystem::temp_directory_path() / ("boxes_" + std::to_string(::getpid()) + ".csv");
  const std::string head =
      "frame,track_id,class,truncated,occluded,cx,cy,cz,yaw,length,width,height\n";
  std::ofstream(path) << head << "3,0,Van,0,0,13.7,4.5,-0.7,0.5,4.4,1.8,2.0\n";
  EXPECT_TRUE(is_labelled_box_file(path));
  const auto boxes = read_labelled_boxes(path);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_EQ(boxes[0].frame, 3u);
  EXPECT_EQ(boxes[0].object.id, 1u);
  EXPECT_EQ(boxes[0].object.label, ObjectClass::kVan);
  EXPECT_EQ(boxes[0].object.box.size_m, Vec3(4.4, 1.8, 2.0));
  std::ofstream(path) << head << "3,0,Van,0,0,13.7,4.5,-0.7,0.5,0,1.8,2.0\n";
  EXPECT_THROW(read_labelled_boxes(path), FormatError);
  const auto reason = [&](const std::string& rows) -> std::string {
    std::ofstream(path) << head << rows;
    try {
      read_labelled_boxes(path);
    } catch (const FormatError& e) {
      return e.what();
    }
    return "";
  };
  const std::string rest = ",0,0,13.7,4.5,-0.7,";
  EXPECT_NE(reason("3,0,Car" + rest + "178.5,4.4,1.8,2\n").find("degrees?"), std::string::npos);
  EXPECT_NE(reason("3,0,Car" + rest + "0.5,4400,1800,2000\n").find("in m?"), std::string::npos);
  std::string cars, pedestrians;
  for (const char* id : {"0", "1", "2"}) {
    cars += std::string("3,") + id + ",Car" + rest + "0.5,1.8,4.4,2\n";
    pedestrians += std::string("3,") + id + ",Pedestrian" + rest + "-6.2,0.5,0.7,2\n";
  }
  EXPECT_NE(reason(cars).find("swapped?"), std::string::npos);
  EXPECT_EQ(reason(pedestrians), "");
  LogInfo log;
  for (uint32_t k = 30; k < 33; ++k) log.scans.push_back({k, 0.1 * k, Pose()});
  EXPECT_THROW(LogTruth(path, log, {}), FormatError) << "frame 3 is no scan";
  log.scans[0].scan = 3;
  EXPECT_NO_THROW(LogTruth(path, log, {}));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace underbrush::perception
