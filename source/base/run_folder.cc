// SPDX-License-Identifier: LGPL-2.1-or-later

#include <greville/base/errors.h>
#include <greville/base/parameters.h>
#include <greville/base/run_folder.h>

#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace greville
{
  using namespace dealii;

  namespace
  {
    /// Return the folders that a run may have made inside its own: the points
    /// at failure, the files of all times, pictures, and the runs of a sweep,
    /// which its table names.
    std::vector<std::string>
    inner_folders(const std::string &folder)
    {
      std::vector<std::string> names = {"failure", "files", "frames"};
      std::ifstream            table(folder + "/sweep.csv");
      std::string              line;
      std::getline(table, line); // The names of columns.
      while (std::getline(table, line))
        {
          const std::string name = line.substr(0, line.find(','));
          if (name.find('/') == std::string::npos && name.rfind('.', 0) != 0)
            names.push_back(name);
        }
      return names;
    }



    /// Return the files that the programs and scripts write, and folders that
    /// contain some.
    std::vector<std::filesystem::path>
    results_in(const std::string &folder)
    {
      static const std::regex names(
        R"((parameters\.prm|summary\.json|messages\.log|output\.txt|view\.py)"
        R"(|(statistics|probes|newton|units|convergence|sweep|element_test)\.csv)"
        R"(|(picture|failure|energies|convergence|element_test|frame_[0-9]+)\.png)"
        R"(|animation\.(gif|mp4)|report\.html)"
        R"(|fields\.pvd|(points|grid|surface|rigid)[A-Za-z0-9_-]*\.vtu)"
        R"(|checkpoint_[0-9]+\.h5(\.new|\.refused)?)(\.tmp)?)");
      std::vector<std::filesystem::path> results;
      for (const auto &entry : std::filesystem::directory_iterator(folder))
        if (entry.is_regular_file() &&
            std::regex_match(entry.path().filename().string(), names))
          results.push_back(entry.path());
      for (const std::string &name : inner_folders(folder))
        {
          const std::filesystem::path inner = folder + "/" + name;
          if (std::filesystem::is_directory(inner) &&
              !results_in(inner.string()).empty())
            results.push_back(inner);
        }
      return results;
    }



    void
    remove_results(const std::string &folder)
    {
      for (const auto &result : results_in(folder))
        if (!std::filesystem::is_directory(result))
          std::filesystem::remove(result);
        else
          {
            remove_results(result.string());
            // Files of the user remain, and so does their folder.
            if (std::filesystem::is_empty(result))
              std::filesystem::remove(result);
          }
    }



    void
    move_results_aside(const std::string &folder)
    {
      const auto results = results_in(folder);
      if (results.empty())
        return;
      unsigned int n     = 1;
      const auto   aside = [&]() {
        return std::filesystem::path(folder) / ("earlier_" + std::to_string(n));
      };
      while (std::filesystem::exists(aside()))
        ++n;
      std::filesystem::create_directory(aside());
      for (const auto &result : results)
        std::filesystem::rename(result, aside() / result.filename());
    }
  } // namespace



  RunFolder::RunFolder(const std::string   &path,
                       const std::string   &parameter,
                       const EarlierResults earlier,
                       const MPI_Comm       comm)
    : folder(path)
    , parameter(parameter)
    , earlier(earlier)
    , comm(comm)
  {
    run_on_first(comm, [&]() {
      create_folder(folder, parameter);
      lock();
      if (earlier != EarlierResults::refuse)
        return;
      const auto results = results_in(folder);
      if (results.empty())
        return;
      release();
      Require(false,
              "The folder <" + folder + "> of the parameter '" + parameter +
                "' has results of an earlier run, <" +
                results[0].filename().string() +
                "> for instance, and 'Output/Earlier results' is refuse.");
    });
  }



  void
  RunFolder::make_room()
  {
    if (earlier != EarlierResults::move_aside &&
        earlier != EarlierResults::remove)
      return;
    run_on_first(comm, [&]() {
      try
        {
          // A run of the earlier sweep may still be running.
          for (const auto &result : results_in(folder))
            if (std::filesystem::exists(result / "lock"))
              RunFolder(result.string(),
                        parameter,
                        EarlierResults::keep,
                        MPI_COMM_SELF);
          if (earlier == EarlierResults::remove)
            remove_results(folder);
          else
            move_results_aside(folder);
        }
      catch (const std::filesystem::filesystem_error &error)
        {
          Require(false,
                  "Earlier results in the folder <" + folder +
                    "> of the parameter '" + parameter +
                    "' cannot be moved or removed: " + error.code().message() +
                    ".");
        }
    });
  }



  void
  RunFolder::lock()
  {
    const std::string file = folder + "/lock";
    errno                  = 0;
    for (bool is_there = false; !is_there;)
      {
        lock_descriptor =
          ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        Require(lock_descriptor >= 0, write_error(file));
        if (flock(lock_descriptor, LOCK_EX | LOCK_NB) != 0 &&
            errno == EWOULDBLOCK)
          {
            std::string   holder;
            std::ifstream in(file);
            std::getline(in, holder);
            close(lock_descriptor);
            lock_descriptor = -1;
            Require(false,
                    "The folder <" + folder + "> of the parameter '" +
                      parameter + "' is in use by another run" +
                      (holder.empty() ? "" : ": " + holder) + ".");
          }
        // The previous run may have removed the file meanwhile.
        struct stat opened, named;
        is_there = fstat(lock_descriptor, &opened) == 0 &&
                   stat(file.c_str(), &named) == 0 &&
                   opened.st_ino == named.st_ino;
        if (!is_there)
          close(lock_descriptor);
      }
    // File systems without locks grant none.
    char host[256] = "";
    gethostname(host, sizeof(host) - 1);
    const std::string text =
      "process " + std::to_string(getpid()) + " on " + host + "\n";
    if (ftruncate(lock_descriptor, 0) != 0 ||
        write(lock_descriptor, text.data(), text.size()) !=
          ssize_t(text.size()))
      {
        const std::string message = write_error(file);
        release();
        Require(false, message);
      }
  }



  void
  RunFolder::release()
  {
    if (lock_descriptor < 0)
      return;
    unlink((folder + "/lock").c_str());
    close(lock_descriptor);
    lock_descriptor = -1;
  }



  RunFolder::~RunFolder()
  {
    release();
  }
} // namespace greville
