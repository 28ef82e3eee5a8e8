#!/bin/sh
# sh parallel.sh SCENE [OPTION ...]   all parts; the same command goes on with what is unfinished
parts=8
seq "$parts" | parallel --quote --jobs 2 --joblog parts.log --resume-failed --termseq TERM,10000,KILL \
    tangency sweep "$@" --part "{}/$parts" --threads 1
