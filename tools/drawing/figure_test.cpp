// Files as readers see them: signatures, sizes, texts; and what cannot be written.
// SPDX-License-Identifier: Apache-2.0
#include "tools/drawing/figure.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "vision/image/picture_file.h"

namespace kaz::figure {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("kaz_figure_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string content(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  fs::path folder_;
};

Image checker(int width, int height) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    const auto c = static_cast<std::uint8_t>((i + i / width) % 2 == 0 ? 250 : 10);
    image.rgb.insert(image.rgb.end(), {c, static_cast<std::uint8_t>(i % 256), 77});
  }
  return image;
}

// Width and height stand big-endian in the first chunk of a PNG file (PNG 1.2, section 11.2.2).
std::pair<unsigned, unsigned> png_size(const std::string& bytes) {
  const auto at = [&](std::size_t i) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes.at(i)));
  };
  const auto number = [&](std::size_t i) {
    return at(i) << 24 | at(i + 1) << 16 | at(i + 2) << 8 | at(i + 3);
  };
  return {number(16), number(20)};
}

TEST_F(Files, PngHasSignatureAndSize) {
  const Result<void> written = write_png(path("a.png"), checker(37, 21));
  ASSERT_TRUE(written) << written.error().message;
  const std::string bytes = content(path("a.png"));
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png_size(bytes), (std::pair{37U, 21U}));
  // Nothing but the file itself is left, and others may read it.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
  EXPECT_NE(fs::status(path("a.png")).permissions() & fs::perms::owner_read, fs::perms::none);
}

// Smooth, so that JPEG loses little: 8 codes of 255 are twice what it lost here.
TEST_F(Files, JpegHoldsThePicture) {
  Image image{40, 24, {}};
  for (int v = 0; v < 24; ++v)
    for (int u = 0; u < 40; ++u)
      for (const int code : {6 * u, 10 * v, 128})
        image.rgb.push_back(static_cast<std::uint8_t>(code));
  ASSERT_TRUE(write_jpeg(path("a.jpg"), image, 90));
  const auto read = vision::read_picture(path("a.jpg"));
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->width, 40);
  ASSERT_EQ(read->height, 24);
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    EXPECT_NEAR(read->rgb[i], image.rgb[i], 8) << i;
  EXPECT_FALSE(write_jpeg(path("b.jpg"), Image{}));
}

TEST_F(Files, SameImageSameBytes) {
  ASSERT_TRUE(write_png(path("a.png"), checker(40, 30)));
  ASSERT_TRUE(write_png(path("b.png"), checker(40, 30)));
  EXPECT_EQ(content(path("a.png")), content(path("b.png")));
}

TEST_F(Files, AFailedWriteLeavesTheOldFile) {
  ASSERT_TRUE(write_png(path("a.png"), checker(4, 4)));
  const std::string before = content(path("a.png"));
  EXPECT_FALSE(write_png(path("a.png"), Image{10, 10, {}}));
  EXPECT_EQ(content(path("a.png")), before);
}

TEST_F(Files, ErrorsNameThePath) {
  const std::string nowhere = path("missing/folder/a.png");
  const Result<void> written = write_png(nowhere, checker(4, 4));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().fault, Fault::environment);
  EXPECT_EQ(written.error().message.find(nowhere), 0U);
  for (const Image& bad :
       {Image{}, Image{-1, 4, {}}, Image{2, 2, {1, 2, 3}}, Image{40000, 1, {}}}) {
    const Result<void> refused = write_png(path("bad.png"), bad);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, Fault::usage);
    EXPECT_FALSE(fs::exists(path("bad.png")));
  }
  // A folder cannot be replaced by a file, and no temporary file stays.
  fs::create_directory(folder_ / "taken.png");
  EXPECT_FALSE(write_png(path("taken.png"), checker(4, 4)));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

PlotPage page() {
  PlotPage page;
  page.title = "Pan & tilt";
  page.x_label = "time [s]";
  LinePlot plot;
  plot.title = "Pan";
  plot.y_label = "angle [deg]";
  Series pot{"potentiometer", kBlue, {}, {}};
  for (int i = 0; i <= 100; ++i) {
    pot.x.push_back(0.1 * i);
    pot.y.push_back(i == 50 ? std::nan("") : 30 * std::sin(0.1 * i));
  }
  plot.series = {pot, {"target <desired>", kOrange, {0, 10}, {-20, 20}, 1.5, Series::Style::dashed}};
  plot.spans = {{0, 2, kGrey, "searching"}, {5, 6, kGrey, "searching"}};
  plot.lines = {{3, kGreen, "limit"}};
  page.plots = {plot, plot};
  return page;
}

TEST_F(Files, SvgHoldsItsLabelsAsText) {
  const Result<void> written = write_plot_svg(path("p.svg"), page());
  ASSERT_TRUE(written) << written.error().message;
  const std::string svg = content(path("p.svg"));
  EXPECT_EQ(svg.find("<svg "), 0U);
  for (const char* text : {">Pan &amp; tilt<", ">time [s]<", ">angle [deg]<", ">potentiometer<",
                           ">target &lt;desired&gt;<", ">searching<", ">limit<", ">10<"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  // One legend entry for both spans of a plot, two plots.
  std::size_t entries = 0;
  for (std::size_t at = svg.find(">searching<"); at != std::string::npos;
       at = svg.find(">searching<", at + 1)) {
    ++entries;
  }
  EXPECT_EQ(entries, 2U);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

TEST_F(Files, PlotPngHasTwiceThePagesSize) {
  ASSERT_TRUE(write_plot_png(path("p.png"), page()));
  // Title 40, two plots of 260, foot 26 px.
  EXPECT_EQ(png_size(content(path("p.png"))), (std::pair{1920U, 2U * (40 + 520 + 26)}));
}

TEST_F(Files, PlotsWithoutDataCanBeDrawn) {
  PlotPage empty;
  EXPECT_TRUE(write_plot_svg(path("e.svg"), empty));
  empty.plots.resize(1);
  empty.plots[0].series = {{"nothing", kRed, {}, {}}, {"one", kRed, {1}, {std::nan("")}}};
  EXPECT_TRUE(write_plot_svg(path("e.svg"), empty));
  EXPECT_TRUE(write_plot_png(path("e.png"), empty));
  EXPECT_EQ(content(path("e.svg")).find("nan"), std::string::npos);
}

TEST(Pictures, MaskKeepsColoursOnlyWhereItIsSet) {
  const Image picture{2, 1, {200, 30, 20, 100, 100, 100}};
  const vision::Mask mask{2, 1, {255, 0}};
  EXPECT_EQ(mask_picture(mask).rgb, (std::vector<std::uint8_t>{255, 255, 255, 0, 0, 0}));
  // 35 % of Y = 100.
  EXPECT_EQ(mask_picture(mask, picture).rgb, (std::vector<std::uint8_t>{200, 30, 20, 35, 35, 35}));
}

TEST(Pictures, CircleIsDrawnWhereItBelongs) {
  Image image{41, 41, std::vector<std::uint8_t>(41 * 41 * 3, 0)};
  draw_circle(image, 20, 20, 12, kWhite, 2);
  const auto red = [&](int u, int v) {
    return image.rgb[static_cast<std::size_t>(v * 41 + u) * 3];
  };
  for (const auto& [u, v] : {std::pair{32, 20}, {8, 20}, {20, 32}, {20, 8}})
    EXPECT_GT(red(u, v), 200);
  EXPECT_EQ(red(20, 20), 0);
  EXPECT_EQ(red(0, 0), 0);
}

TEST(Pictures, EnlargeRepeatsPixels) {
  const Image large = enlarge({2, 1, {1, 2, 3, 4, 5, 6}}, 2);
  EXPECT_EQ(large.width, 4);
  EXPECT_EQ(large.height, 2);
  EXPECT_EQ(large.rgb, (std::vector<std::uint8_t>{1, 2, 3, 1, 2, 3, 4, 5, 6, 4, 5, 6,  //
                                                  1, 2, 3, 1, 2, 3, 4, 5, 6, 4, 5, 6}));
}

TEST(Pictures, ResizedTheyKeepTheirColours) {
  Image image{4, 2, std::vector<std::uint8_t>(24, 200)};
  for (std::size_t i = 0; i < 6; ++i) image.rgb[i] = image.rgb[12 + i] = 40;  // the left half
  const Image small = resize(image, 2, 1), wide = resize(image, 8, 3);
  EXPECT_EQ(small.rgb, (std::vector<std::uint8_t>{40, 40, 40, 200, 200, 200}));
  ASSERT_EQ(wide.rgb.size(), 3u * 8 * 3);
  EXPECT_EQ(wide.rgb.front(), 40);
  EXPECT_EQ(wide.rgb.back(), 200);
  EXPECT_EQ(resize(Image{}, 8, 3).width, 0);
}

TEST(Pictures, AFrameIsWhite) {
  const Image all = framed(Image{1, 1, {9, 8, 7}});
  ASSERT_EQ(all.width, 1 + 2 * kFrame_px);
  ASSERT_EQ(all.height, all.width);
  EXPECT_EQ(std::ranges::count(all.rgb, 255), static_cast<std::ptrdiff_t>(all.rgb.size() - 3));
  EXPECT_EQ(all.rgb[all.rgb.size() / 2], 8);
}

TEST(Pictures, APartIsPastedAsFarAsThereIsRoom) {
  const Image part{2, 2, {1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4}};
  const auto pasted = [&](int left, int top) {
    Image image{3, 2, std::vector<std::uint8_t>(18, 0)};
    paste(image, part, left, top);
    std::vector<int> reds;
    for (std::size_t i = 0; i < 18; i += 3) reds.push_back(image.rgb[i]);
    return reds;
  };
  EXPECT_EQ(pasted(0, 0), (std::vector<int>{1, 2, 0, 3, 4, 0}));
  EXPECT_EQ(pasted(2, 1), (std::vector<int>{0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(pasted(-1, -1), (std::vector<int>{4, 0, 0, 0, 0, 0}));
  EXPECT_EQ(pasted(3, 0), (std::vector<int>(6, 0)));
  EXPECT_EQ(pasted(0, -2), (std::vector<int>(6, 0)));
}

TEST(Pictures, PanelsStandSideBySide) {
  const std::vector<Panel> panels{{checker(64, 48), "left"},
                                  {checker(32, 48), "right"},
                                  {checker(64, 48), "below"},
                                  {Image{}, "nothing"}};
  const Image image = compose(panels, 2, 96);
  // 128 and 64 px wide, 14 px between, 16 px margins; two rows of 96 + 30, 26 px around.
  EXPECT_EQ(image.width, 128 + 64 + 14 + 32);
  EXPECT_EQ(image.height, 2 * (96 + 30) + 26);
  EXPECT_EQ(image.rgb[0], 255);  // the margin is white
  EXPECT_GT(compose({}, 0, 100).width, 0);
}

}  // namespace
}  // namespace kaz::figure
