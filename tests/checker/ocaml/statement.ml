(* Statements and their goals. Sections 5 and 9 of docs/certificates.md. *)

open Text
open Tree
open Ball
open Value
open Goal
open Language

type statement = {
  goals : (tree * relation) list;
  box : (string * range) list;
  said : tree list; (* what has to have a value *)
  given : tree list;
  zeros : tree list;
}

let read_goals left right relation tolerance =
  let scalars () =
    match (left, right) with Scalar a, Scalar b -> (a, b) | _ -> refuse "matrices are equal or not, and have no other relation"
  in
  let differences () = entries (combine (function [ a; b ] -> subtract a b | _ -> assert false) [ left; right ]) in
  let difference () = let a, b = scalars () in subtract a b in
  let opposite () = let a, b = scalars () in subtract b a in
  match (relation, tolerance) with
  | "=", None -> List.map (fun d -> (d, Equal)) (differences ())
  | "=", Some e ->
      let d = difference () in
      [ (Sum [ e; d ], AtLeast); (Sum [ e; negate d ], AtLeast) ]
  | _, Some _ -> refuse "a tolerance goes with = only"
  | "!=", None -> (
      match (left, right) with
      | Scalar a, Scalar b -> [ (subtract a b, Unequal) ]
      | _ -> [ (Sum (zero :: List.map (fun d -> Prod [ d; d ]) (differences ())), Unequal) ])
  | ">", None -> [ (difference (), Above) ]
  | ">=", None -> [ (difference (), AtLeast) ]
  | "<", None -> [ (opposite (), Above) ]
  | "<=", None -> [ (opposite (), AtLeast) ]
  | _ -> refuse "unknown relation %S" relation

(* Supposes a condition between numbers, or an equation of matrices entry by entry. *)
let suppose s (x, mark, y) =
  let distance a b = match (a, b) with a, Num q when Q.sign q = 0 -> a | Num q, b when Q.sign q = 0 -> negate b | _ -> subtract a b in
  let join t l = if List.mem t l then l else l @ [ t ] in
  let with_value s t = { s with said = join t s.said } in
  let away s d = with_value s (Pow (d, Num Q.minus_one)) in
  let at_least s d = { (with_value s d) with given = join d s.given } in
  let equal_to s d = { (with_value s d) with zeros = join d s.zeros } in
  match (x, mark, y) with
  | _, "=", _ ->
      let all = combine (function [ a; b ] -> distance a b | _ -> assert false) [ x; y ] in
      List.fold_left equal_to s (entries all)
  | Scalar x, mark, Scalar y -> (
      match mark with
      | "!=" -> let d = distance x y in away (with_value s d) d
      | ">" -> let d = distance x y in away (at_least s d) d
      | "<" -> let d = distance y x in away (at_least s d) d
      | ">=" -> at_least s (distance x y)
      | _ -> at_least s (distance y x))
  | _ -> refuse "given: matrices have no other relation"

let plain_keys = [ "left"; "right"; "relation"; "symbols"; "exists"; "tolerance" ]
let more_keys = [ "shapes"; "given"; "rates" ]

let read_statement value =
  let o = get_object "statement" value in
  if List.mem_assoc "order" o then outside "statement with order";
  if List.mem_assoc "random" o then outside "statement with random numbers";
  let is_long = List.exists (fun k -> List.mem_assoc k o) more_keys in
  let values = get_keys "statement" (if is_long then plain_keys @ more_keys else plain_keys) value in
  match values @ if is_long then [] else [ Object []; List []; Object [] ] with
  | [ left; right; relation; symbols; exists; tolerance; shapes; given; rates ] ->
      let read (name, v) = if is_name name then (name, read_range name v) else refuse "expected a name" in
      let box = List.map read (get_object "symbols" symbols) in
      let context = make_context (List.map fst box) shapes rates in
      let hypotheses = List.map (fun v -> read_condition context (get_text "given" v)) (get_list "given" given) in
      List.iter (fun v -> ignore (read_value_of context (get_text "exists" v))) (get_list "exists" exists);
      let left = read_value_of context (get_text "left" left) in
      let right = read_value_of context (get_text "right" right) in
      let tolerance = match tolerance with Null -> None | v -> Some (get_tree "tolerance" v) in
      let goals = read_goals left right (get_text "relation" relation) tolerance in
      let said = entries left @ entries right @ Option.to_list tolerance @ List.rev context.said in
      List.fold_left suppose { goals; box; said; given = []; zeros = [] } hypotheses
  | _ -> assert false

(* A tree of `given` that is a symbol, or -1 times a symbol, cuts the range at 0. *)
let goal_of s (tree, relation) =
  let goal = { tree; relation; box = s.box; exists = s.said; given = s.given; zeros = s.zeros } in
  let cut goal = function
    | Sym name -> cut_range goal name 1
    | Prod [ Num q; Sym name ] when Q.equal q Q.minus_one -> cut_range goal name (-1)
    | _ -> goal
  in
  List.iter (fun t -> check_symbols (premise goal t relation)) (s.said @ s.given @ s.zeros);
  List.fold_left cut goal s.given

(* All that the statement says has a finite ball at a point in the box, and the hypotheses hold there. *)
let check_values s point =
  check_point s.box point;
  let balls = List.map (fun (name, t) -> (name, number_ball name t)) point in
  let value name = match List.assoc_opt name balls with Some x -> x | None -> no_symbols name in
  List.iter (fun t -> if finite_ball value t = None then refuse "no value at the point") s.said;
  let is_positive t = match finite_ball value t with Some x -> sign_of x.lo >= 0 | None -> false in
  let is_null t = Algebra.vanishes (put point t) in
  shown "a hypothesis does not hold at the point"
    (List.for_all (fun t -> is_positive t || is_null t) s.given && List.for_all is_null s.zeros);
  value
