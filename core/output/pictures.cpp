#include "core/output/pictures.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "core/output/frame.h"

namespace sluice {

namespace {

namespace fs = std::filesystem;

fs::path find_script(const std::string& name) {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& candidate : {program / name, program / ".." / name, program / "../share/sluice" / name})
    if (fs::exists(candidate)) return fs::canonical(candidate);
  throw std::runtime_error(fmt::format("{} was not found beside the program in {}", name, program.string()));
}

std::string python() {
  if (const char* chosen = std::getenv("SLUICE_PYTHON")) return chosen;
  return fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
}

std::vector<std::string> arguments_of(const PictureRequest& request) {
  std::vector<std::string> words = {request.folder.string()};
  if (!request.fields.empty()) words.emplace_back("--fields");
  words.insert(words.end(), request.fields.begin(), request.fields.end());
  if (!request.times.empty()) words.emplace_back("--times");
  for (const double t : request.times) words.push_back(fmt::format("{}", t));
  if (request.animation) words.emplace_back("--animation");
  return words;
}

/// Of the word number `i` of output.pictures, which may be a list or one word alone.
Place place_of_picture(const Case& definition, std::size_t i) {
  const Node& pictures = *definition.source.find("output")->find("pictures");
  return pictures.kind == Node::Kind::list ? pictures.items.at(i).place : pictures.place;
}

}  // namespace

void require_pictured_fields(const Case& definition, const Particles& particles) {
  std::vector<std::string> names;
  for (const auto& field : result_fields(particles)) names.push_back(field.name);
  for (std::size_t i = 0; i < definition.output.pictures.size(); ++i) {
    const std::string& name = definition.output.pictures[i];
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    throw CaseError(place_of_picture(definition, i),
                    fmt::format("pictures: unknown field '{}'; {}; `[]` draws none", name, allowed_words(name, names)));
  }
}

bool draw_pictures(const PictureRequest& request) {
  return run_script("pictures.py", arguments_of(request), request.quiet);
}

bool run_script(const std::string& name, const std::vector<std::string>& arguments, bool quiet) {
  std::vector<std::string> words = {python(), find_script(name).string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("the program that draws pictures could not be started");
  if (child == 0) {
    if (quiet) {
      const int nowhere = open("/dev/null", O_WRONLY);
      if (nowhere >= 0) dup2(nowhere, STDOUT_FILENO);
    }
    execvp(pointers[0], pointers.data());
    fmt::print(stderr, "pictures: {} could not be started\n", words[0]);
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace sluice
