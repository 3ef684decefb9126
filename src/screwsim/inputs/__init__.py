"""What comes from outside: fields that declare it, files that hold it, faults that say what is wrong with it."""
