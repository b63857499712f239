#include "app/cli/spy/spy_gui.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "common/error.h"

namespace tautline::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInstall =
    "sudo apt-get install default-jre liblcm-java libjchart2d-java libjide-oss-java "
    "libxmlgraphics-commons-java libcommons-io-java";
constexpr std::array<const char*, 5> kJars{"lcm", "jchart2d", "jide-oss", "xmlgraphics-commons",
                                           "commons-io"};
constexpr const char* kTypes = "tautline-types.jar";

[[noreturn]] void missing(const std::string& what, const std::string& remedy) {
  throw InputError({.key = "--gui", .problem = what + " is missing", .remedy = remedy},
                   ExitCode::kFailed);
}

/// Beside this program where it was built, else where packages put it.
fs::path typesJar() {
  std::error_code ignored;
  for (const fs::path& folder :
       {fs::read_symlink("/proc/self/exe", ignored).parent_path(), fs::path("/usr/share/java")}) {
    if (fs::exists(folder / kTypes, ignored)) return folder / kTypes;
  }
  missing(kTypes,
          "make it in the source folder: ./run spy (or cmake --build --preset release "
          "--target java_types)");
}

}  // namespace

void becomeLcmSpy(const std::string& lcm_url) {
  std::string class_path;
  for (const char* jar : kJars) {
    const fs::path path = fs::path("/usr/share/java") / (std::string(jar) + ".jar");
    if (!fs::exists(path)) missing(path.string(), kInstall);
    class_path += path.string() + ':';
  }
  class_path += typesJar().string();
  ::setenv("LCM_DEFAULT_URL", lcm_url.c_str(), 1);
  ::execlp("java", "java", "-Djava.net.preferIPv4Stack=true", "-cp", class_path.c_str(),
           "lcm.spy.Spy", static_cast<char*>(nullptr));
  missing(std::string("java (") + std::strerror(errno) + ")", kInstall);
}

}  // namespace tautline::cli
