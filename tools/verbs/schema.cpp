// photorque schema: the keys of experiments for editors, documents and users.
#include <cstdio>
#include <set>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "tools/keys/registry.h"
#include "tools/verbs/verb.h"

namespace photorque::verbs::schema {
namespace {

// A key with its path, such as "source.power_W".
struct FoundKey {
  std::string path;  // including the choice that adds the key: "source (led).power_W"
  const Key* key;
};

// Whether a name is a key in any unit: "array.gap_mm" is the key "array.gap_m".
bool is_of_key(const std::string& name, const std::string& wanted) {
  if (name == wanted) return true;
  const KeyUnit unit = unit_of_key(name), other = unit_of_key(wanted);
  return !unit.unit.empty() && !other.unit.empty() && unit.stem == other.stem;
}

// Collects the paths of all keys as a user writes them.
void add_paths(const std::vector<Key>& keys, const std::string& above, std::set<std::string>& all) {
  for (const Key& key : keys) {
    const std::string path = above + key.name;
    all.insert(path);
    add_paths(key.keys, path + ".", all);
    for (const Key::Choice& choice : key.choices) add_paths(choice.keys, above, all);
  }
}

void find(const std::vector<Key>& keys, const std::string& written, const std::string& path,
          const std::string& wanted, std::vector<FoundKey>& found) {
  for (const Key& key : keys) {
    const std::string name = written.empty() ? key.name : written + "." + key.name;
    const std::string full = path.empty() ? key.name : path + "." + key.name;
    if (is_of_key(name, wanted)) found.push_back({full, &key});
    find(key.keys, name, full, wanted, found);
    for (const Key::Choice& choice : key.choices) {
      find(choice.keys, written, path + " (" + choice.name + ")", wanted, found);
    }
  }
}

// Prints the keys of a table, one per line, and the values of a choice with their keys.
void print_keys(const Key& table) {
  for (const Key& key : table.keys) {
    const std::string otherwise = default_in_words(key);
    std::printf("  %-28s %s%s%s\n", key.name.c_str(), key.what.c_str(),
                otherwise.empty() ? "" : "; ", otherwise.c_str());
  }
  for (const Key& key : table.keys) {
    for (const Key::Choice& choice : key.choices) {
      const std::string names = joined_text(choice.keys, ", ", &Key::name);
      if (names.empty()) continue;
      std::printf("  with %s = \"%s\": %s\n", key.name.c_str(), choice.name.c_str(), names.c_str());
    }
  }
}

void print_key(const std::string& wanted) {
  const std::vector<Key> tables = experiment_keys();
  std::vector<FoundKey> found;
  find(tables, "", "", wanted, found);
  if (found.empty()) {
    std::set<std::string> known;
    add_paths(tables, "", known);
    const std::string similar = nearest(wanted, known);
    throw InputError({"--key"}, "", in_quotes(wanted),
                     "a key with its table, " +
                         (similar.empty() ? "such as source.power_W" : "perhaps " + similar));
  }
  for (const FoundKey& one : found) {
    std::printf("%s: %s\n", one.path.c_str(), description_of(*one.key).c_str());
    print_keys(*one.key);
  }
}

struct Options : CommandOptions {
  std::string key;                               // to be explained
  std::vector<std::filesystem::path> documents;  // documents whose tables of keys are replaced
};

void add_options(Command& command, Options& options) {
  command.add_common(options);
  command.add("--out", options.out, "Write the schema into this file");
  command.add("--key", options.key,
              "Print the meaning of one key, such as source.power_W, instead of the schema");
  command
      .add("--document", options.documents,
           "Update the tables of keys in this Markdown file, instead of writing the schema")
      .is_one_each = true;
  command.mistake = [&options] {
    return options.json && (!options.key.empty() || !options.documents.empty())
               ? "--json: found with --key or --document, expected without: only the schema is JSON"
               : "";
  };
}

void run(const Options& options, const Program&) {
  if (!options.key.empty()) return print_key(options.key);
  for (const std::filesystem::path& document : options.documents) {
    write_file_whole(document,
                     with_key_tables(read_file(document), experiment_keys(), document.string()));
  }
  if (!options.documents.empty()) return;
  const std::string schema = json_schema(experiment_keys());
  if (options.out) {
    write_file_whole(*options.out, schema);
  } else {
    std::fputs(schema.c_str(), stdout);
  }
}

}  // namespace

Verb kind() {
  return {
      "schema",
      "All keys of an experiment as a JSON Schema for editors, or the meaning of one key (--key)",
      command_with(add_options, run)};
}

}  // namespace photorque::verbs::schema
