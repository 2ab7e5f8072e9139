// Rows of the CEC library of SAM and PAN files of PVsyst against the figures that they list.
#include "photovoltaics/fit/module_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/refusal.h"

namespace photorque {
namespace {

// Four rows of the libraries of SAM 2021.12.02 and, the last, SAM 2018.11.11, with its rows of
// units and variables.
const std::string library =
    "Name,Manufacturer,Technology,Bifacial,STC,PTC,A_c,Length,Width,N_s,I_sc_ref,V_oc_ref,I_mp_ref,"
    "V_mp_ref,alpha_sc,beta_oc,T_NOCT,a_ref,I_L_ref,I_o_ref,R_s,R_sh_ref,Adjust,gamma_r,BIPV,"
    "Version,"
    "Date\n"
    "Units,,,,,,m2,m,m,,A,V,A,V,A/K,V/K,C,V,A,A,Ohm,Ohm,%,%/K,,,\n"
    "[0],lib_manufacturer,cec_material,lib_is_bifacial,,,cec_area,,,cec_n_s,cec_i_sc_ref,"
    "cec_v_oc_ref,cec_i_mp_ref,cec_v_mp_ref,cec_alpha_sc,cec_beta_oc,cec_t_noct,cec_a_ref,"
    "cec_i_l_ref,cec_i_o_ref,cec_r_s,cec_r_sh_ref,cec_adjust,cec_gamma_r,,,\n"
    "Ablytek 6MN6A270,Ablytek,Mono-c-Si,0,270.643,242.1,1.627,1.64,0.992,60,9.34,38.63,8.81,30.72,"
    "0.00486614,-0.121182,47.4,1.58733,9.34243,2.51E-10,0.374013,1440.5,12.6561,-0.4509,N,"
    "SAM 2021.12.02,12/1/2021\n"
    "Advance Power API-P210,Advance "
    "Power,Multi-c-Si,0,210.148,186.8,1.638,1.646,0.995,60,7.6,35.94,"
    "7.09,29.64,0.00437608,-0.120111,47.6,1.52964,7.60815,4.66E-10,0.247801,231.181,12.9624,-0."
    "4501,"
    "N,SAM 2021.12.02,12/1/2021\n"
    "Advanced Solar Power (Hangzhou) ASP-S1-80,Advanced Solar Power (Hangzhou),Thin Film,0,79.985,"
    "75.2,0.72,1.2,0.6,145,0.95,118.9,0.85,94.1,0.00085215,-0.363596,45.2,4.30037,0.958205,8.68E-"
    "13,"
    "13.7213,1588.73,-12.4295,-0.2634,N,SAM 2021.12.02,12/1/2021\n"
    "LG Electronics Inc. LG400N2W-A5,LG,Mono-c-Si,0,400.316,368.4,2,2,1,72,10.47,49.3,9.86,40.6,"
    "0.003141,-0.12818,47.7,1.821208,10.481150,1.807477e-11,0.312859,293.805420,9.380614,-0.36,N,"
    "SAM 2018.11.11 r2,1/3/2019\n";

double power_W(const RatedPoint& point) {
  return point.maximum_A * point.maximum_V;
}

struct Listed {
  const char* name;
  double stc_W, power_slope_1_K;  // columns STC and gamma_r, which SAM's own solver met
};

TEST(ModuleFile, RowsOfTheCecLibraryGiveTheirListedFigures) {
  for (const Listed& listed : std::initializer_list<Listed>{
           {"Ablytek 6MN6A270", 270.643, -0.4509e-2},
           {"Advance Power API-P210", 210.148, -0.4501e-2},
           {"Advanced Solar Power (Hangzhou) ASP-S1-80", 79.985, -0.2634e-2},
           {"LG Electronics Inc. LG400N2W-A5", 400.316, -0.36e-2}}) {
    const ListedModule m = module_in(library, "cec.csv", listed.name);
    const RatedPoint p = m.predict(1000.0, 298.15);
    // Saturation currents are listed to three digits.
    EXPECT_NEAR(p.short_circuit_A / m.rated.short_circuit_A, 1.0, 2e-3) << listed.name;
    EXPECT_NEAR(p.open_circuit_V / m.rated.open_circuit_V, 1.0, 1e-3) << listed.name;
    EXPECT_NEAR(p.maximum_A * p.maximum_V / listed.stc_W, 1.0, 2e-3) << listed.name;
    const RatedPoint warm = m.predict(1000.0, 298.15 + 10.0);
    const double slope_1_K =
        (warm.maximum_A * warm.maximum_V / (p.maximum_A * p.maximum_V) - 1.0) / 10.0;
    EXPECT_NEAR(slope_1_K / listed.power_slope_1_K, 1.0, 0.05) << listed.name;
  }
  const ListedModule m = module_in(library, "cec.csv", "LG400N2W");
  EXPECT_EQ(m.cells_in_series, 72);
  EXPECT_NEAR(m.cell.reference_area_m2, 2.0 / 72.0, 1e-12);
  EXPECT_EQ(module_in(library, "cec.csv", "LG_Electronics_Inc__LG400N2W_A5").name, m.name);
}

// Jinko JKM720N-66HL5-BDV as its PAN file of 2024 has it. OperPoints: efficiencies by PVsyst at
// 1100 to 100 W/m² over that at 1000.
const std::string pan =
    "PVObject_=pvModule\r\n  Version=7.2.3\r\n\r\n  PVObject_Commercial=pvCommercial\r\n"
    "    Manufacturer=Jinkosolar 2024\r\n    Model=JKM720N-66HL5-BDV\r\n    Width=1.303\r\n"
    "    Height=2.384\r\n  End of PVObject pvCommercial\r\n\r\n  Technol=mtSiMono\r\n  NCelS=66\r\n"
    "  NCelP=2\r\n  GRef=1000\r\n  TRef=25.0\r\n  PNom=720.0\r\n  Isc=18.670\r\n  Voc=49.04\r\n"
    "  Imp=17.610\r\n  Vmp=40.89\r\n  muISC=8.37\r\n  muVocSpec=-137.8\r\n  muPmpReq=-0.290\r\n"
    "  RShunt=1000\r\n  Rp_0=80000\r\n  Rp_Exp=5.50\r\n  RSerie=0.168\r\n  Gamma=1.054\r\n"
    "  muGamma=-0.0003\r\nEnd of PVObject pvModule\r\n";

TEST(ModuleFile, APanFileGivesItsListedFigures) {
  const ListedModule m = module_in(pan, "jinko.PAN", "");
  EXPECT_EQ(m.name, "Jinkosolar 2024 JKM720N-66HL5-BDV");
  EXPECT_EQ(m.strings, 2);
  EXPECT_NEAR(m.cell.reference_area_m2, 1.303 * 2.384 / 132.0, 1e-12);
  const RatedPoint p = m.predict(1000.0, 298.15);
  const double stc_W = p.maximum_A * p.maximum_V;
  EXPECT_NEAR(p.short_circuit_A, 18.67, 1e-6);
  EXPECT_NEAR(p.open_circuit_V, 49.04, 1e-6);
  EXPECT_NEAR(stc_W / 720.0, 1.0, 2e-3);
  for (const auto& [light_W_m2, gain] : {std::pair{1100.0, -0.32e-2},
                                         {800.0, 0.55e-2},
                                         {600.0, 0.82e-2},
                                         {400.0, 0.55e-2},
                                         {200.0, -1.00e-2},
                                         {100.0, -3.41e-2}}) {
    const RatedPoint dim = m.predict(light_W_m2, 298.15);
    EXPECT_NEAR(dim.maximum_A * dim.maximum_V / (stc_W * light_W_m2 / 1000.0) - 1.0, gain, 1e-3)
        << light_W_m2;
  }
  const RatedPoint warm = m.predict(1000.0, 308.15);
  EXPECT_NEAR((warm.maximum_A * warm.maximum_V / stc_W - 1.0) / 10.0, -0.290e-2, 0.1e-3);
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

// The gap of a silicon heterojunction is that of silicon.
TEST(ModuleFile, HeterojunctionsAndRibbonsAreOfSilicon) {
  const double gap_eV = module_in(pan, "one.PAN", "").cell.gap_eV;
  for (const char* technology : {"mtHIT", "mtEFG"}) {
    EXPECT_EQ(module_in(changed(pan, "mtSiMono", technology), "one.PAN", "").cell.gap_eV, gap_eV);
  }
}

// The figures and slopes of the file are met although its circuit has a term more.
TEST(ModuleFile, APanFileWithRecombinationGivesItsRatedFigures) {
  const ListedModule m =
      module_in(changed(changed(pan, "mtSiMono", "mtCdTe"), "Gamma", "D2MuTau=0.5\r\n  Gamma"),
                "film.PAN", "");
  ASSERT_FALSE(m.notes.empty());
  EXPECT_THAT(m.notes.back(), testing::HasSubstr("D2MuTau = 0.5"));
  const RatedPoint p = m.predict(1000.0, 298.15), warm = m.predict(1000.0, 308.15);
  EXPECT_NEAR(p.short_circuit_A / 18.67, 1.0, 1e-4);
  EXPECT_NEAR(p.open_circuit_V / 49.04, 1.0, 1e-4);
  EXPECT_NEAR(p.maximum_A / 17.61, 1.0, 1e-3);
  EXPECT_NEAR(p.maximum_V / 40.89, 1.0, 1e-3);
  EXPECT_NEAR(power_W(warm) / power_W(p), 1.0 - 0.0290, 1e-3);
  EXPECT_NEAR(warm.short_circuit_A - p.short_circuit_A, 0.0837, 1e-3);
}

// First Solar FS-4112A-2 as its PAN file of 2014 has it, of the module files of pvsyst_tools. The
// powers are those of PVsyst's equations (A. Mermoud, T. Lejeune, 25th EU PVSEC (2010), 4BV.1.114,
// with the recombination of J. Merten et al., IEEE Trans. Electron Devices 45 (1998) 423, at a
// built-in voltage of 0.9 V) with its RSerie, RShunt, Gamma, muGamma and D2MuTau, solved by SciPy
// 1.10 (brentq, minimize_scalar).
const std::string cadmium_telluride =
    "PVObject_=pvModule\n  Manufacturer=First Solar\n  Model=FS-4112A-2\n  Width=0.600\n"
    "  Height=1.200\n  Technol=mtCdTe\n  NCelS=108\n  NCelP=2\n  GRef=1000\n  TRef=25.0\n"
    "  Isc=1.750\n  Voc=87.74\n  Imp=1.601\n  Vmp=70.16\n  muISC=0.70\n  muVocSpec=-79.8\n"
    "  muPmpReq=-0.340\n  RShunt=7500\n  Rp_0=15000\n  Rp_Exp=4.00\n  RSerie=4.230\n"
    "  Gamma=1.484\n  muGamma=0.0011\n  D2MuTau=0.250\n  ARev=3.200\n  BRev=10.008\n"
    "End of PVObject pvModule\n";

TEST(ModuleFile, CadmiumTellurideFollowsTheTemperatureOfPvsyst) {
  const std::string unstated = changed(cadmium_telluride, "muVocSpec=-79.8", "muVocSpec=0.0");
  for (const std::string& text : {cadmium_telluride, unstated}) {
    const ListedModule m = module_in(text, "cdte.PAN", "");
    EXPECT_NEAR(power_W(m.predict(1000.0, 298.15)), 112.46, 0.002 * 112.46);
    EXPECT_NEAR(power_W(m.predict(1000.0, 333.15)), 99.19, 0.006 * 99.19);
    EXPECT_NEAR(power_W(m.predict(500.0, 353.15)), 45.66, 0.012 * 45.66);
    EXPECT_NEAR(power_W(m.predict(1000.0, 263.15)), 125.49, 0.003 * 125.49);
  }
}

// DuPont Apollo DA148-C1, two junctions, of the same collection; its own figures and slope.
TEST(ModuleFile, AmorphousSiliconWithRecombinationGivesItsRatedFigures) {
  std::string text = cadmium_telluride;
  for (const auto& [from, to] : {std::pair{"mtCdTe", "mtuCSi_aSiH"},
                                 {"NCelS=108", "NCelS=119"},
                                 {"NCelP=2", "NCelP=1"},
                                 {"Isc=1.750", "Isc=1.500"},
                                 {"Voc=87.74", "Voc=157.00"},
                                 {"Imp=1.601", "Imp=1.210"},
                                 {"Vmp=70.16", "Vmp=122.00"},
                                 {"muISC=0.70", "muISC=1.30"},
                                 {"muPmpReq=-0.340", "muPmpReq=-0.300"},
                                 {"Gamma=1.484", "Gamma=3.023"},
                                 {"D2MuTau=0.250", "D2MuTau=2.800"}}) {
    text = changed(text, from, to);
  }
  const ListedModule m = module_in(text, "thin.PAN", "");
  const double stc_W = power_W(m.predict(1000.0, 298.15));
  EXPECT_NEAR(stc_W, 1.21 * 122.0, 0.002 * 147.62);
  EXPECT_NEAR(power_W(m.predict(1000.0, 308.15)) / stc_W, 1.0 - 0.030, 1e-3);
}

TEST(ModuleFile, TheStatedAreaOfACellIsUsedAndUnusedPartsAreNamed) {
  const ListedModule m = module_in(cadmium_telluride, "cdte.PAN", "");
  EXPECT_NEAR(m.cell.reference_area_m2, 0.72 / 216.0, 1e-12);
  EXPECT_THAT(m.notes, testing::Contains(testing::HasSubstr("not used: BRev")));
  const ListedModule stated =
      module_in(changed(cadmium_telluride, "  GRef", "  CellArea=31.3\n  GRef"), "cdte.PAN", "");
  EXPECT_NEAR(stated.cell.reference_area_m2, 31.3e-4, 1e-12);
  EXPECT_TRUE(module_in(pan, "jinko.PAN", "").notes.empty());
}

std::string message(const std::string& text, const std::string& name) {
  return refusal_of([&] { module_in(text, "modules.csv", name); });
}

TEST(ModuleFile, MissingAndAmbiguousNamesAreRejected) {
  EXPECT_THAT(message(library, "Advance"), testing::HasSubstr("2 modules have it"));
  EXPECT_THAT(message(library, "Unlisted 100"), testing::HasSubstr("0 modules have it"));
  EXPECT_THAT(message(library, ""), testing::HasSubstr("module_name"));
  EXPECT_THAT(message("voltage_V,current_A\n1,2\n", "x"), testing::HasSubstr("PVObject_=pvModule"));
  EXPECT_THAT(message("Name,N_s,A_c\nOne,60,1.6\n", "One"), testing::HasSubstr("I_sc_ref"));
  EXPECT_THAT(message(changed(pan, "mtSiMono", "mtaSiHTan"), ""), testing::HasSubstr("Technol"));
  EXPECT_THAT(message(changed(pan, "RShunt=1000", "RShunt=2"), ""), testing::HasSubstr("RShunt"));
}

}  // namespace
}  // namespace photorque
