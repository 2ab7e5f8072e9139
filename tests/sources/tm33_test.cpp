// IES TM-33: the same lamps in XML and in LM-63, whose reader has its own test, and every way in
// which such a file can be wrong.
#include <gmock/gmock.h>

#include "sources/photometry/file.h"
#include "tests/refusal.h"
#include "tests/sources/ies_writer.h"

namespace photorque {
namespace {

struct Direction {
  double h_deg, v_deg, value;
};

std::string int_data(const std::vector<Direction>& directions) {
  std::ostringstream text;
  for (const auto& [h_deg, v_deg, value] : directions) {
    text << "        <IntData h=\"" << h_deg << "\" v=\"" << v_deg << "\">" << value
         << "</IntData>\n";
  }
  return text.str();
}

std::string document(const std::string& emitter, const std::string& type = "IES_C") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<IESTM33-22>\n  <Version>1.1</Version>\n"
         "  <Header>\n    <Manufacturer>maker &amp; sons</Manufacturer>\n"
         "    <Description>a lamp\n in two lines</Description>\n"
         "    <ReportNumber>7</ReportNumber>\n  </Header>\n"
         "  <Equipment><Gonioradiometer><Type>" +
         type + "</Type></Gonioradiometer></Equipment>\n" + emitter + "</IESTM33-22>\n";
}

std::string emitter(const std::string& data, const std::string& kind = "Radiant") {
  return "  <Emitter>\n    <Quantity>1</Quantity>\n    <InputWattage>10</InputWattage>\n    <" +
         kind + "Data>\n      <" + kind + "Intensity>\n" + data + "      </" + kind +
         "Intensity>\n    </" + kind + "Data>\n  </Emitter>\n";
}

// 100 (2 − v/45) in one plane, as LM-63 and as TM-33.
const std::string one_lamp_ies =
    "IESNA:LM-63-2002\nTILT=NONE\n1 1000 2 3 1 1 2 0 0 0\n1 1 10\n0 45 90\n0\n100 50 0\n";
const std::vector<Direction> small_table = {{0, 0, 100}, {0, 45, 50}, {0, 90, 0}};
const std::string small_data = "        <Multiplier>2</Multiplier>\n" + int_data(small_table);

void expect_same_table(const PhotometricFile& a, const PhotometricFile& b) {
  EXPECT_EQ(a.table.pole, b.table.pole);
  EXPECT_EQ(a.table.polar_rad, b.table.polar_rad);
  EXPECT_EQ(a.table.azimuth_rad, b.table.azimuth_rad);
  EXPECT_EQ(a.table.closed, b.table.closed);
  EXPECT_EQ(a.table.intensity, b.table.intensity);
}

void expect_refused_at(const std::string& text, const std::string& words, int line = 0) {
  const std::string message = refusal_of([&] { read_photometric(text, "lamp.xml"); });
  EXPECT_THAT(message, testing::HasSubstr(words));
  EXPECT_THAT(message, testing::HasSubstr("lamp.xml:" + (line > 0 ? std::to_string(line) : "")));
}

TEST(Tm33File, IsTheSameLampAsInLm63) {
  const PhotometricFile file = read_photometric(document(emitter(small_data)), "lamp.xml");
  expect_same_table(file, read_ies(one_lamp_ies, ""));
  EXPECT_EQ(file.format, "IESTM33-22");
  EXPECT_EQ(file.input_power_W, 10.0);
  EXPECT_FALSE(file.stated_flux_lm);
  EXPECT_THAT(file.labels, testing::ElementsAre(
                               testing::Pair("TEST", "7"), testing::Pair("MANUFAC", "maker & sons"),
                               testing::Pair("LUMINAIRE", "a lamp  in two lines")));
  EXPECT_TRUE(file.notices.empty());
  expect_same_table(read_ies(write_ies(file), ""), file);
}

// Any order of directions, blanks in the name of the symmetry as some copies of the schema have
// them, a byte order mark, and the root of the older standard.
TEST(Tm33File, UnfoldsStatedSymmetriesAsLm63DoesImpliedOnes) {
  const std::string ies =
      "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 2 1 2 0 0 0\n1 1 0\n0 45 90\n0 90\n9 6 1 9 4 2\n";
  std::string text = document(emitter(
      "        <Symm>Symm _ Quad</Symm>\n"
      "        <NumberMeasured>6</NumberMeasured><NumberHorz>2</NumberHorz>\n"
      "        <NumberVert>3</NumberVert>\n" +
          int_data({{90, 90, 2}, {90, 45, 4}, {90, 0, 9}, {0, 90, 1}, {0, 45, 6}, {0, 0, 9}}),
      "Photon"));
  const PhotometricFile file = read_photometric("\xef\xbb\xbf" + text, "lamp.xml");
  expect_same_table(file, read_ies(ies, ""));
  EXPECT_EQ(file.table.planes(), 4u);
  const std::string without = text.substr(0, text.find("        <Symm>")) +
                              text.substr(text.find("        <NumberMeasured>"));
  expect_same_table(read_photometric(without, "lamp.xml"), file);
}

TEST(Tm33File, ReadsTypeBAsLm63Does) {
  const std::string ies =
      "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 3 2 2 0 0 0\n1 1 0\n0 40\n-30 0 30\n5 1 7 2 6 3\n";
  const std::string text = document(
      emitter(
          int_data({{-30, 0, 5}, {-30, 40, 1}, {0, 0, 7}, {0, 40, 2}, {30, 0, 6}, {30, 40, 3}})),
      "CIE_B");
  expect_same_table(read_photometric(text, "lamp.xml"), read_ies(ies, ""));
}

// TM-33-22 takes the coordinates of its types from the goniometers of LM-75: types A and B count h
// clockwise seen from above (so that h = 30, v = 30 and the beam are left-handed), type C counts it
// against the clock, from C0 towards C90, with v from the nadir. Directions in the emitter's frame,
// which looks along the beam (z) with C0 along x and C90, seen from above on the left of C0, along
// −y.
TEST(Tm33File, EmitsAtTheAnglesOfTheStandard) {
  constexpr double sine = 0.5, cosine = 0.86602540378443865;
  struct Lamp {
    const char* type;
    double h_deg, v_deg;
    Vec3 expected;
  };
  const Lamp lamps[] = {{"CIE_A", 30, 0, {0, sine, cosine}},  {"IES_A", 0, 30, {sine, 0, cosine}},
                        {"CIE_B", 30, 0, {0, sine, cosine}},  {"IES_B", 0, 30, {sine, 0, cosine}},
                        {"CIE_C", 0, 30, {sine, 0, cosine}},  {"IES_C", 90, 30, {0, -sine, cosine}},
                        {"IES_C", 270, 30, {0, sine, cosine}}};
  for (const Lamp& lamp : lamps) {
    const bool along_beam = lamp.type[4] == 'C';
    std::vector<Direction> directions;
    for (const double h_deg : along_beam ? std::vector<double>{0, 90, 180, 270}
                                         : std::vector<double>{-60, -30, 0, 30, 60}) {
      for (const double v_deg :
           along_beam ? std::vector<double>{0, 30, 60} : std::vector<double>{-60, -30, 0, 30, 60}) {
        const bool lit = h_deg == lamp.h_deg && v_deg == lamp.v_deg;
        directions.push_back({h_deg, v_deg, lit ? 1000.0 : 0.0});
      }
    }
    const PhotometricFile file =
        read_photometric(document(emitter(int_data(directions)), lamp.type), "lamp.xml");
    const TabulatedIntensity intensity(file.table);
    const auto at = [&](const Vec3& direction) {
      const GoniometerAngles angle = table_angles(file.table.pole, direction);
      return intensity.at(angle.polar_rad, angle.azimuth_rad);
    };
    const std::string which = lamp.type + std::string(" h ") + std::to_string(lamp.h_deg);
    EXPECT_NEAR(at(lamp.expected), 1000.0, 1e-6) << which;
    EXPECT_NEAR(at({-lamp.expected.x(), -lamp.expected.y(), cosine}), 0.0, 1e-6) << which;
  }
}

TEST(Tm33File, TakesTheIntensityNearestToWatts) {
  std::string luminous = emitter(int_data({{0, 0, 3}, {0, 90, 2}}), "Luminous");
  const std::string flux = "<LuminousFlux>55</LuminousFlux>\n    </LuminousData>";
  luminous.replace(luminous.find("</LuminousData>"), 15, flux);
  const PhotometricFile alone = read_photometric(document(luminous), "lamp.xml");
  EXPECT_EQ(alone.table.intensity, (std::vector<double>{3, 2}));
  EXPECT_EQ(alone.stated_flux_lm, 55.0);
  std::string both = luminous;
  const std::string radiant = "    <RadiantData><RadiantIntensity>\n" +
                              int_data({{0, 0, 8}, {0, 90, 4}}) +
                              "    </RadiantIntensity></RadiantData>\n  </Emitter>";
  both.replace(both.find("  </Emitter>"), 12, radiant);
  const PhotometricFile file = read_photometric(document(both), "lamp.xml");
  EXPECT_EQ(file.table.intensity, (std::vector<double>{8, 4}));
  EXPECT_FALSE(file.stated_flux_lm);
}

// Lengths lie along C90, the emitter's y.
TEST(Tm33File, LightLeavesTheBottomFace) {
  const auto with_areas = [](const std::string& areas) {
    std::string text = emitter(small_data);
    text.replace(text.find("  </Emitter>"), 12,
                 "    <EmissionAreas>" + areas + "</EmissionAreas>\n  </Emitter>");
    return read_photometric(document(text), "lamp.xml");
  };
  const auto area = [](const std::string& length, const std::string& width,
                       const std::string& offset, const std::string& more) {
    return "<BottomArea><Length>" + length + "</Length><Width>" + width + "</Width><LengthOffset>" +
           offset + "</LengthOffset><WidthOffset>0</WidthOffset>" + more + "</BottomArea>";
  };
  const auto face = [](const std::string& areas) {
    return "<BottomFace><NumberBottom>1</NumberBottom>" + areas + "</BottomFace>";
  };
  const PhotometricFile disc =
      with_areas(face(area("0.02", "0.02", "0", "<Circular>true</Circular>")));
  EXPECT_EQ(disc.opening.shape, Opening::Shape::ellipse);
  EXPECT_EQ(disc.opening.x_m, 0.02);
  EXPECT_TRUE(disc.notices.empty());
  const PhotometricFile pair = with_areas(
      face(area("0.5", "0.6", "-0.1", "") + area("0.5", "0.6", "0.1", "")) + "<TopFace/>");
  EXPECT_EQ(pair.opening.shape, Opening::Shape::rectangle);
  EXPECT_DOUBLE_EQ(pair.opening.x_m, 0.6);
  EXPECT_DOUBLE_EQ(pair.opening.y_m, 0.7);
  EXPECT_EQ(pair.notices.size(), 2u);
}

TEST(Tm33File, ReportsTheMistakeWithItsPlace) {
  expect_refused_at("<IESTM33-22>\n<Header>\n</Emitter>", "well-formed XML", 3);
  expect_refused_at("<html>\n</html>", "<html>", 1);
  expect_refused_at(document(""), "none with a table of intensities");
  expect_refused_at(document(emitter(small_data) + emitter(small_data)), "a second one", 23);
  expect_refused_at(document(emitter(small_data), "CUSTOM"), "CUSTOM");
  const auto refused = [](const std::string& data, const std::string& words) {
    expect_refused_at(document(emitter(data)), words);
  };
  refused(int_data({{0, 0, 1}, {0, 90, 1}, {90, 0, 1}}), "none at h 90, v 90");
  refused(int_data({{0, 0, 1}, {0, 90, 1}, {0, 0, 1}}), "h 0, v 0 twice");
  refused(int_data({{0, 0, 1}}), "1 vertical angles");
  refused(int_data({{0, 0, 0}, {0, 90, 0}}), "none above zero");
  refused(int_data({{0, -5, 1}, {0, 90, 1}}), "-5 to 90");
  refused("<Symm>Symm_Arbitrary</Symm>" + small_data, "Symm_Arbitrary");
  refused("<Symm>Symm_Full</Symm>" + int_data({{0, 0, 1}, {0, 90, 1}, {90, 0, 1}, {90, 90, 1}}),
          "Symm_Full with 2 planes");
  expect_refused_at(document(emitter("<Symm>Symm_None</Symm>" + small_data), "IES_B"),
                    "Symm_None with angles from 0");
  refused("<NumberHorz>2</NumberHorz>" + small_data, "1, as many as there are");
  refused("<Multiplier>1e400</Multiplier>" + small_data, "a number");
  refused("<Multiplier>1e308</Multiplier>" + small_data, "overflows");
  refused("<IntData h=\"0\">1</IntData>" + small_data, "no attribute v");
  refused("<IntData h=\"x\" v=\"1\">1</IntData>" + small_data, "found \"x\"");
}

}  // namespace
}  // namespace photorque
