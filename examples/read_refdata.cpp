// Reads reference data of shadercheck in the format csv.
//
//     shadercheck refdata generate sphere --profile binary32 --format csv --output sphere.csv
//     c++ -std=c++17 -O2 read_refdata.cpp -o read_refdata && ./read_refdata sphere.csv
//
// Counts the outputs, those with a bound, and those whose nearest binary32 number is within it.

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

static std::vector<std::string> split(const std::string &line)
{
  std::vector<std::string> values;
  std::stringstream stream(line);
  for (std::string value; std::getline(stream, value, ',');) values.push_back(value);
  // A last value without text is a value, too.
  if (!line.empty() && line.back() == ',') values.push_back("");
  return values;
}

int main(int argc, char **argv)
{
  if (argc != 2)
  {
    std::cerr << "usage: read_refdata FILE.csv\n";
    return 2;
  }
  std::ifstream file(argv[1]);
  std::string provenance, names;
  if (!std::getline(file, provenance) || !std::getline(file, names))
  {
    std::cerr << argv[1] << ": cannot be read\n";
    return 2;
  }
  if (provenance.find("\"schema\":\"shadercheck-refdata\",\"schema_version\":\"1.") == std::string::npos)
  {
    std::cerr << argv[1] << ": not reference data of schema 1\n";
    return 2;
  }

  const std::vector<std::string> columns = split(names);
  std::map<std::string, size_t> place;
  for (size_t k = 0; k < columns.size(); ++k) place[columns[k]] = k;

  size_t samples = 0, elements = 0, bounded = 0, within = 0;
  for (std::string line; std::getline(file, line); ++samples)
  {
    const std::vector<std::string> values = split(line);
    if (values.size() != columns.size())
    {
      std::cerr << argv[1] << ": sample " << samples << " is cut off\n";
      return 1;
    }
    for (const auto &[name, at] : place)
    {
      if (name.rfind("expected.", 0) != 0) continue;
      const std::string output = name.substr(9);
      const double expected = std::strtod(values[at].c_str(), nullptr);
      const float nearest = std::strtof(values[place.at("nearest." + output)].c_str(), nullptr);
      const auto bound = place.find("bound." + output);
      ++elements;
      if (bound == place.end()) continue;
      const float limit = std::strtof(values[bound->second].c_str(), nullptr);
      if (!std::isfinite(limit)) continue;
      ++bounded;
      if (std::fabs(nearest - expected) <= limit) ++within;
    }
  }
  std::cout << samples << " samples, " << elements << " elements, " << bounded << " with a bound, " << within
            << " within it\n";
  return samples > 0 && within == bounded ? 0 : 1;
}
