#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/grbl/firmware.h"
#include "drivers/grbl/firmware_tables.h"

namespace leafcutter::drivers {
namespace {

using testing::HasSubstr;

FirmwareSigns signs_of(std::initializer_list<std::string_view> lines) {
    FirmwareSigns signs;
    for (const std::string_view line : lines) {
        signs.take(line);
    }
    return signs;
}

TEST(FirmwareSigns, TellsTheFirmwaresApart) {
    const FirmwareSigns grbl =
        signs_of({"Grbl 1.1h ['$' for help]", "[VER:1.1h.20190830:]", "[OPT:V,15,128]"});
    EXPECT_EQ(grbl.kind(), GrblFirmware::Grbl);
    EXPECT_EQ(grbl.name(), "Grbl 1.1h");
    EXPECT_EQ(grbl.build_options(), "V");
    EXPECT_EQ(grbl.receive_budget(), 127U);
    EXPECT_EQ(grbl.longest_line(), 79U);

    const FirmwareSigns hal =
        signs_of({"GrblHAL 1.1f ['$' or '$HELP' for help]", "[VER:1.1f.20260817:]",
                  "[OPT:VNML+,100,1024,3,0]", "[AXS:3:XYZ]", "[FIRMWARE:grblHAL]"});
    EXPECT_EQ(hal.kind(), GrblFirmware::GrblHal);
    EXPECT_EQ(hal.name(), "grblHAL 1.1f");
    EXPECT_EQ(hal.receive_budget(), 894U);  // With room for a hold.
    EXPECT_EQ(hal.longest_line(), 254U);

    const FirmwareSigns fluid = signs_of({"Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]",
                                          "[VER:3.7 FluidNC v3.7.8 (ESP32-wifi):]", "[OPT:PHSW]"});
    EXPECT_EQ(fluid.kind(), GrblFirmware::FluidNc);
    EXPECT_EQ(fluid.name(), "FluidNC v3.7.8");
    EXPECT_EQ(fluid.receive_budget(), 127U);  // It states none.
    EXPECT_EQ(fluid.longest_line(), 126U);    // No more than fits.

    const FirmwareSigns old = signs_of({"Grbl 0.9j ['$' for help]"});
    EXPECT_EQ(old.kind(), GrblFirmware::Other);
    EXPECT_EQ(old.receive_budget(), 127U);
}

TEST(FirmwareSigns, IsNoneTheWorseForNonsense) {
    for (const std::string_view line :
         {"", "[", "[OPT:", "[OPT:,", "[OPT:V,15,]", "[OPT:V,15,-3]", "[OPT:V,15,99999999999999]",
          "GRBLHAL", "grbl", "[VER:FluidNC", "Grbl 1.1 [FluidNC"}) {
        const FirmwareSigns signs = signs_of({line});
        EXPECT_GE(signs.receive_budget(), 127U) << line;
        EXPECT_GE(signs.longest_line(), 79U) << line;
    }
}

TEST(FirmwareTables, NeverShareTheNumbersThatDiffer) {
    EXPECT_THAT(alarm_text(GrblFirmware::Grbl, 10), HasSubstr("dual axis"));
    EXPECT_THAT(alarm_text(GrblFirmware::GrblHal, 10), HasSubstr("emergency stop"));
    EXPECT_THAT(alarm_text(GrblFirmware::FluidNc, 10), HasSubstr("spindle"));
    EXPECT_EQ(alarm_text(GrblFirmware::Other, 10), "ALARM:10");
    EXPECT_THAT(alarm_text(GrblFirmware::FluidNc, 14), HasSubstr("home"));
    EXPECT_THAT(alarm_text(GrblFirmware::GrblHal, 1), HasSubstr("hard limit"));
    EXPECT_EQ(error_text(GrblFirmware::Grbl, 60), "error:60");
    EXPECT_THAT(error_text(GrblFirmware::GrblHal, 60), HasSubstr("card"));
    EXPECT_THAT(error_text(GrblFirmware::FluidNc, 110), HasSubstr("log in"));
    EXPECT_THAT(error_text(GrblFirmware::FluidNc, 22), HasSubstr("feed"));
    EXPECT_EQ(error_text(GrblFirmware::Grbl, -1), "error:-1");
    EXPECT_EQ(setting_name(GrblFirmware::Grbl, 32), "laser mode");
    EXPECT_EQ(setting_name(GrblFirmware::Grbl, 33), "");
}

}  // namespace
}  // namespace leafcutter::drivers
